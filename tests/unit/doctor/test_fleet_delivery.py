"""What the doctor says of the delivery to a fleet database."""

from datetime import timedelta
from pathlib import Path

from cellctl.clock import utc_now
from cellctl.config.cell import CellConfig, FleetConfig
from cellctl.doctor.finding import Finding, Health
from cellctl.doctor.fleet_delivery import delivery_findings
from cellctl.doctor.pc import Pc
from cellctl.records.files.delivery_file import FOLDER, NAME, DeliveryState, write_state
from tests.rigs.shipped import shipped_cell
from tests.unit.doctor.healthy_pc import CELL_FILE


def state_of(**changes: object) -> DeliveryState:
    """Of a delivery that is well this very moment, but for the changes."""
    well = DeliveryState(told=utc_now(), delivered=utc_now(), still_to_come=0)
    return well.model_copy(update=changes)


def fleet_cell(folder: Path) -> CellConfig:
    fleet = FleetConfig(url="postgresql://north@db/fleet", password_file=str(folder / "password"))
    return shipped_cell(CELL_FILE.name).model_copy(update={"fleet": fleet})


def found(folder: Path, state: DeliveryState | None) -> Finding:
    pc = Pc(root=folder)
    if state is not None:
        write_state(pc.path(FOLDER), state)
    (finding,) = delivery_findings(pc, fleet_cell(folder))
    return finding


def test_a_cell_without_a_fleet_is_not_asked(tmp_path: Path) -> None:
    assert list(delivery_findings(Pc(root=tmp_path), shipped_cell(CELL_FILE.name))) == []


def test_all_is_delivered(tmp_path: Path) -> None:
    finding = found(tmp_path, state_of())
    assert finding.health is Health.GOOD
    assert finding.found.startswith("all entries delivered, the last at ")


def test_a_delivery_that_fails_has_its_reason_and_what_waits(tmp_path: Path) -> None:
    state = state_of(fault="F831 server away", remedy="look at the network", still_to_come=7)
    finding = found(tmp_path, state)
    assert (finding.health, finding.remedy) == (Health.DOUBTFUL, "look at the network")
    assert "7 entries still to come" in finding.found
    assert "F831" in finding.found


def test_a_forwarder_that_is_not_there_or_has_gone(tmp_path: Path) -> None:
    assert "nothing is heard" in found(tmp_path, None).found
    gone = found(tmp_path, state_of(told=utc_now() - timedelta(minutes=10)))
    assert gone.health is Health.DOUBTFUL
    assert "silent since" in gone.found
    Pc(root=tmp_path).path(FOLDER / NAME).write_text("half a", encoding="utf-8")
    assert "nothing is heard" in found(tmp_path, None).found
