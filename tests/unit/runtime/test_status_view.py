"""The snapshot does not raise, whatever the devices do."""

import math

from cellctl.api.modbus.register_map import VALIDITY_REGISTERS
from cellctl.api.modbus.status import Handshake, values
from cellctl.errors.link import StaleData
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import RobotMode
from cellctl.packml.state import State
from tests.unit.daemon_rig import DaemonRig


async def test_a_cell_at_rest(rig: DaemonRig) -> None:
    status = rig.shown()
    assert status.state is State.STOPPED
    assert not status.ready
    assert status.simulation
    assert status.calibration_ok
    assert (status.recipe_active, status.run_number, status.serial) == (0, 0, "")
    assert math.isfinite(status.force_z_n)
    assert values(status, Handshake(), 1)["alarm_count"] == 0


async def test_a_robot_on_its_panel_is_shown(rig: DaemonRig) -> None:
    rig.bench.cell.aux_2.looks["mode"] = RobotMode.MANUAL
    assert rig.shown().manual


async def test_silent_devices_do_not_silence_the_status(rig: DaemonRig) -> None:
    rig.bench.cell.main.faults["state"] = StaleData("2 s")
    rig.bench.cell.guard.raw = rig.bench.cell.guard.raw[:0]
    for path in rig.bench.calibrations.path.glob("*.json"):
        path.unlink()
    status = rig.shown()
    assert not status.manual
    assert math.isnan(status.force_z_n)
    assert status.validity_h == dict.fromkeys(VALIDITY_REGISTERS, 0.0)
    assert not status.calibration_ok


async def test_a_trip_is_shown(rig: DaemonRig) -> None:
    rig.bench.cell.guard.trip = GuardTrip(TripReason.RAW_LIMIT, 1.0, "Fz 60 N", 2, 60.0)
    assert rig.shown().force_guard_tripped
