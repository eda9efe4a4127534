"""All subjects in the order in which they hinder a start."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cellctl.config import CellConfig, load_cell
from cellctl.doctor.accounts import account_findings
from cellctl.doctor.clock import clock_findings
from cellctl.doctor.devices import device_findings
from cellctl.doctor.finding import Finding, Health, bad, good
from cellctl.doctor.fleet_delivery import delivery_findings
from cellctl.doctor.network import limits_finding, network_findings
from cellctl.doctor.pc import Pc
from cellctl.doctor.program import program_findings, unit_findings
from cellctl.doctor.scheduling import scheduling_findings
from cellctl.doctor.service import installed_service
from cellctl.doctor.storage import storage_findings
from cellctl.doctor.versions import version_findings
from cellctl.errors import CellError
from cellctl.version import ROOT

_SHIPPED_UNIT = ROOT / "systemd" / "cellctl.service"
_LOCK = ROOT / "requirements.lock"


@dataclass(frozen=True, slots=True)
class Subject:
    """One part of the PC and what was found there."""

    title: str
    findings: tuple[Finding, ...]

    @property
    def health(self) -> Health:
        """The worst of it."""
        found = {finding.health for finding in self.findings}
        return next((one for one in (Health.BAD, Health.DOUBTFUL) if one in found), Health.GOOD)


def diagnose(cell_file: Path, pc: Pc | None = None) -> Iterator[Subject]:
    """Every subject; without a unit, or without a good cell file, those that need none."""
    pc = pc or Pc()
    cell, of_file = _cell(cell_file)
    service = installed_service(pc)
    yield Subject("Software", tuple(version_findings(_LOCK)))
    yield Subject("Cell file", (of_file,))
    yield Subject("Service", tuple(unit_findings(pc, service, _SHIPPED_UNIT)))
    if service is not None:
        yield Subject("Program", tuple(program_findings(pc, service)))
        yield Subject("Accounts", tuple(account_findings(pc, service, cell)))
        yield Subject("Guard's time", tuple(scheduling_findings(pc, service, cell)))
        yield Subject("Records", tuple(storage_findings(pc, service, cell)))
    yield Subject("Clock", tuple(clock_findings(pc)))
    if cell is not None:
        if of_network := tuple(network_findings(pc, cell)):
            yield Subject("Network", of_network)
        if of_fleet := tuple(delivery_findings(pc, cell)):
            yield Subject("Fleet", of_fleet)
        if service is not None:
            limits = limits_finding(pc, cell, str(cell_file))
            yield Subject("Devices", (limits, *device_findings(pc, service, cell)))


def _cell(path: Path) -> tuple[CellConfig | None, Finding]:
    try:
        cell = load_cell(path)
    except CellError as fault:
        remedy = f"cellctl check {path}"
        if not path.exists():
            remedy = "`make install` puts one there, or name yours: cellctl doctor CELL.toml"
        return None, bad("cell file", str(fault), remedy)
    return cell, good("cell file", f"{path}, cell '{cell.name}'")
