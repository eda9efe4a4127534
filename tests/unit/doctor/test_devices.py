"""A CAN bus of the cell file is looked for, also where its interface is the usual one unsaid."""

from pathlib import Path

import pytest

from cellctl.doctor.devices import device_findings
from cellctl.doctor.finding import Health
from cellctl.doctor.service import installed_service
from tests.rigs.shipped import shipped_cell
from tests.unit.doctor.healthy_pc import CELL_FILE, HealthyPc


@pytest.mark.parametrize(
    ("state", "health"), [(None, Health.BAD), ("down", Health.BAD), ("up", Health.GOOD)]
)
def test_a_can_bus(tmp_path: Path, state: str | None, health: Health) -> None:
    cell = shipped_cell(CELL_FILE.name)
    name, sensor = next(iter(cell.force_sensors.items()))
    settings = {**sensor.settings, "transport": "can", "can_channel": "can1"}
    on_can = sensor.model_copy(update={"settings": settings})
    cell = cell.model_copy(update={"force_sensors": {name: on_can}})
    healthy = HealthyPc(tmp_path)
    if state is not None:
        healthy.write("/sys/class/net/can1/operstate", state)
    service = installed_service(healthy.pc())
    assert service is not None
    found = {one.subject: one for one in device_findings(healthy.pc(), service, cell)}
    assert found["can1"].health is health
