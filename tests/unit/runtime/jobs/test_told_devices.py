"""The record says what instruments have said of themselves, without asking any."""

from types import SimpleNamespace
from typing import cast

from cellctl.cell.devices import Cell
from cellctl.guard.health import GuardHealth
from cellctl.packml.state import State
from cellctl.records.parts import TOLD
from cellctl.runtime.jobs.told_devices import told_devices
from tests.unit.daemon_rig import DaemonRig


def test_what_a_device_has_not_said_has_no_entry() -> None:
    robots = {
        "arm": SimpleNamespace(link_facts=lambda: {"CMD": "job program 3", "dead man": "200 ms"}),
        "aux": SimpleNamespace(link_facts=dict),
    }
    guards = {
        "force": SimpleNamespace(health=lambda: GuardHealth(True, sensor_serial="S-12 (SFWV 1.2)")),
        "other": SimpleNamespace(health=lambda: GuardHealth(alive=True)),
    }
    document = told_devices(cast(Cell, SimpleNamespace(robots=robots, guards=guards)))
    assert document.key == TOLD
    assert document.content == {
        "arm": "CMD job program 3, dead man 200 ms",
        "force": "S-12 (SFWV 1.2)",
    }


async def test_every_run_has_it(rig: DaemonRig) -> None:
    await rig.started()
    await rig.to(State.COMPLETED)
    assert TOLD in {document.key for document in (await rig.record()).documents}
