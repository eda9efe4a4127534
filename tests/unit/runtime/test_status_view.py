"""The snapshot does not raise, whatever the devices do."""

import math

import pytest

from cellctl.api.modbus.register_map import VALIDITY_REGISTERS
from cellctl.api.modbus.status import Handshake, values
from cellctl.errors.link import StaleData
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import RobotMode
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
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


async def test_times_run_and_refusals_are_kept_the_newest_first(rig: DaemonRig) -> None:
    await rig.idle()
    entered = rig.shown()
    rig.ahead_s = 100.0
    assert rig.shown().state_time_s == pytest.approx(entered.state_time_s + 100.0, abs=5.0)
    assert rig.shown().mode_time_s >= rig.shown().state_time_s
    assert await rig.take(Command.UNHOLD) is RejectCode.COMMAND_NOT_ALLOWED
    assert await rig.take(Command.START, recipe_id=99) is RejectCode.RECIPE_UNKNOWN
    assert await rig.take(Command.UNDEFINED, unit_mode=7) is RejectCode.MODE_NOT_CONFIGURED
    found = [(entry.state, entry.request, entry.code) for entry in rig.shown().refusals]
    assert found == [
        (State.IDLE, 0x107, RejectCode.MODE_NOT_CONFIGURED),
        (State.IDLE, Command.START, RejectCode.RECIPE_UNKNOWN),
        (State.IDLE, Command.UNHOLD, RejectCode.COMMAND_NOT_ALLOWED),
    ]
    await rig.take(Command.ABORT)
    await rig.to(State.ABORTED)
    assert rig.shown().mode_time_s > 90.0, "the mode has not changed"


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


async def test_a_force_with_the_payload_s_weight_in_it_is_no_force_on_the_part(
    rig: DaemonRig,
) -> None:
    rig.bench.cell.guard.gravity_compensated = False
    assert math.isnan(rig.shown().force_z_n)


async def test_a_force_of_which_nothing_has_come_for_seconds_is_not_present(
    rig: DaemonRig,
) -> None:
    rig.bench.cell.guard.silent_s = 0.9
    assert math.isfinite(rig.shown().force_z_n), "a sensor that reconnects"
    rig.bench.cell.guard.silent_s = 25.0
    status = rig.shown()
    assert math.isnan(status.force_z_n)
    assert values(status, Handshake(), 1)["force_z"] == -(2**31)


async def test_a_force_in_the_sensor_s_own_axes_is_no_force_along_the_part_s(
    rig: DaemonRig,
) -> None:
    await rig.bench.cell.guard.set_wrench_frame(None)
    assert math.isnan(rig.shown().force_z_n)


async def test_a_trip_is_shown(rig: DaemonRig) -> None:
    rig.bench.cell.guard.trip = GuardTrip(TripReason.RAW_LIMIT, 1.0, "Fz 60 N", 2, 60.0)
    assert rig.shown().force_guard_tripped


async def test_the_touch_that_a_step_waits_for_is_no_stop_for_the_line(rig: DaemonRig) -> None:
    rig.bench.cell.guard.trip = GuardTrip(TripReason.TOUCH, 1.0, "touch after 12 ms")
    assert rig.shown().force_guard_tripped, "nobody waits for it"
    rig.unit.board.update(contact=True)
    assert not rig.shown().force_guard_tripped
    rig.unit.board.leave_step()
    assert rig.shown().force_guard_tripped
    with rig.bench.as_cell.trips_awaited("force"):
        assert not rig.shown().force_guard_tripped
        rig.bench.cell.guard.trip = GuardTrip(TripReason.RAW_LIMIT, 1.0, "Fz 60 N", 2, 60.0)
        assert rig.shown().force_guard_tripped, "beyond a limit, whoever waits"
