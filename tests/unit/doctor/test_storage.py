"""Where the unit lets the service write, whole folders count and not beginnings of names."""

from pathlib import Path

import pytest

from cellctl.doctor.service import installed_service
from cellctl.doctor.storage import storage_findings
from tests.rigs.shipped import shipped_cell
from tests.unit.doctor.healthy_pc import CELL_FILE, HealthyPc

AT_SRV = (
    "ExecStart=/opt/cellctl/current/.venv/bin/cellctl run /etc/cellctl/cell.toml "
    "--data-dir /srv/data"
)


@pytest.mark.parametrize(
    ("allowed", "writable"),
    [
        ("/srv/data", True),
        ("/srv", True),
        ("-/srv/data", True),
        ("/var/log /srv", True),
        ("/srv/database", False),
        ("/srv/data/old", False),
    ],
)
def test_a_folder_below_one_that_may_be_written(
    tmp_path: Path, allowed: str, *, writable: bool
) -> None:
    healthy = HealthyPc(tmp_path)
    command = next(
        line
        for line in healthy.at("/etc/systemd/system/cellctl.service").read_text().splitlines()
        if line.startswith("ExecStart=")
    )
    healthy.in_unit(command, f"{AT_SRV}\nReadWritePaths={allowed}")
    service = installed_service(healthy.pc())
    assert service is not None
    found = storage_findings(healthy.pc(), service, shipped_cell(CELL_FILE.name))
    refused = any("lets the service write nothing" in one.found for one in found)
    assert refused is not writable
