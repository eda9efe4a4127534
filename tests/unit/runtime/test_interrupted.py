"""After a daemon that died in a run, the next start says where the arm stands and what it feels."""

import asyncio
import math
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.force import LiftOffHeld, PartLeftInPlace
from cellctl.errors.link import StaleData
from cellctl.errors.records.store import RecordNotWritten, RunInterrupted
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.calibrations import PAYLOAD
from cellctl.records.store import RunStore
from tests.unit.cell.guard import TinyGuard
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
async def died(rig: DaemonRig, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> DaemonRig:
    """A rig whose daemon died in contact, with 20 N; the unit is not open."""

    def lost(*_: object, **__: object) -> None:
        raise RecordNotWritten("the daemon was killed")

    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    with monkeypatch.context() as killed:
        killed.setattr(RunStore, "close_run", lost)
        killed.setattr(RunStore, "keep_end", lost)
        await rig.close()
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 12.0, -16.0, 0.0, 0.0, 0.0], (50, 1))
    guard.asked.clear()
    guard.gravity_compensated = guard.in_part_frame = False
    return rig


async def test_line_alarms_and_record_say_where_the_arm_stands(died: DaemonRig) -> None:
    moves = len(died.bench.cell.main.moves)
    await died.open()
    status = died.shown()
    assert status.state is State.STOPPED
    assert RunInterrupted.number in status.alarms
    assert status.warning
    record = await died.record()
    assert record.head.result == "interrupted"
    text = next(one.text for one in record.alarms if one.number == RunInterrupted.number)
    x_mm, y_mm, z_mm = died.bench.cell.main.flange.translation * 1e3
    assert "run 1, step 50 mate" in text
    assert f"main at {x_mm:.1f} {y_mm:.1f} {z_mm:.1f} mm" in text
    assert "force: 20.0 N (Fx 0.0, Fy 12.0, Fz -16.0 N), without the payload's weight" in text
    assert len(died.bench.cell.main.moves) == moves
    await died.close()
    await died.open()
    alarms = (await died.record()).alarms
    assert [one.number for one in alarms].count(RunInterrupted.number) == 1, "said once"


async def test_what_is_not_known_is_said_and_the_cell_comes_up(died: DaemonRig) -> None:
    died.bench.cell.guard.faults["set_gravity_compensation"] = StaleData("guard")
    died.bench.cell.aux_1.faults["state"] = StaleData("2 s")
    await died.open()
    assert died.shown().state is State.STOPPED
    text = (await died.record()).alarms[-1].text
    assert "aux_1 unknown (F207" in text
    assert "payload included" in text


async def test_after_the_restart_the_force_has_the_sign_it_had_in_the_run(died: DaemonRig) -> None:
    guard, bench = died.bench.cell.guard, died.bench
    guard.sensor_T_wrench = None
    await died.open()
    assert guard.in_part_frame
    in_the_run = bench.deck.arm.flange_T_sensor.inv() * pose_from_xyzabc(bench.recipe.flange_T_deck)
    assert guard.sensor_T_wrench is not None
    np.testing.assert_allclose(guard.sensor_T_wrench.as_matrix(), in_the_run.as_matrix())


async def test_without_the_axes_of_the_part_no_component_has_a_sign(died: DaemonRig) -> None:
    guard = died.bench.cell.guard
    died.bench.cell.main.flange = died.bench.flange_over_seat(0.5)
    await died.open()
    assert not guard.in_part_frame, "no deck stands in a frame there"
    text = (await died.record()).alarms[-1].text
    assert "force: 20.0 N, without the payload's weight" in text
    assert "Fz" not in text
    assert math.isnan(died.shown().force_z_n)


def noisy(guard: TinyGuard) -> None:
    """A sensor that repeats its values counts as frozen, and nothing is lifted."""
    guard.raw = guard.raw + np.random.default_rng(1).normal(0.0, 0.05, guard.raw.shape)


async def test_reset_after_the_crash_lifts_off_under_the_guard_from_a_zero_of_its_own(
    died: DaemonRig,
) -> None:
    await died.open()
    main, guard = died.bench.cell.main, died.bench.cell.guard
    noisy(guard)
    before, left_at = len(main.moves), main.flange
    guard.asked.clear()
    # Of every move the robot itself sees to it that its guard is armed.
    await died.idle()
    lift, *_ = main.moves[before:]
    assert lift.kind == "linear"
    frame_z = died.bench.station.rotation.apply([0.0, 0.0, 1.0])
    assert frame_z @ (lift.target.translation - left_at.translation) > 0.0
    limit_n = died.bench.recipe.mating.limit_force_n
    first, rise = guard.limits[-2:]
    assert first.filtered[2] == rise.filtered[2] == limit_n
    begun = guard.asked[: guard.asked.index("arm") + 1]
    assert begun[-3:] == ["set_wrench_frame", "tare", "arm"]
    assert RunInterrupted.number in died.shown().alarms, "until somebody has acknowledged it"
    assert not died.unit.machine.faults


async def test_a_deck_that_is_held_ends_the_reset_after_a_crash_and_costs_no_calibration(
    died: DaemonRig,
) -> None:
    await died.open()
    main, guard = died.bench.cell.main, died.bench.cell.guard
    noisy(guard)
    before, limited = len(main.moves), len(guard.limits)
    main.road_is_free = asyncio.Event()
    main.on_the_way.clear()
    assert await died.take(Command.RESET) is RejectCode.NONE
    await died.until(main.on_the_way.is_set)
    guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz -50.3 N, limit 50.00 N", 2, -50.3)
    await died.until(lambda: main.stops > 0)
    main.road_is_free.set()
    await died.to(State.ABORTED)
    assert [type(fault) for fault in died.unit.machine.faults] == [LiftOffHeld]
    assert len(main.moves) == before + 1
    assert len(guard.limits) == limited + 1
    await died.unit.background.drain()
    died.bench.snapshot()  # would raise CalibrationInvalidated


async def test_a_restart_does_not_forget_a_pull_where_the_payload_is_known(
    died: DaemonRig,
) -> None:
    bench = died.bench
    main, guard = bench.cell.main, bench.cell.guard
    payload = bench.snapshot().get(PAYLOAD).gravity_compensation
    base_R_sensor = main.flange.rotation * bench.deck.arm.flange_T_sensor.rotation
    inwards = (main.flange * bench.grip).rotation.apply([0.0, 0.0, -200.0])
    pull = np.concatenate([base_R_sensor.inv().apply(inwards), np.zeros(3)])
    guard.raw = np.tile(payload.load(base_R_sensor) + pull, (50, 1))
    await died.open()
    before = len(main.moves)
    for _ in range(2):
        assert await died.take(Command.RESET) is RejectCode.NONE
        await died.to(State.ABORTED)
        assert [type(fault) for fault in died.unit.machine.faults] == [LiftOffHeld]
        assert "pulled with 120 N already" in str(died.unit.machine.faults[0])
        assert len(main.moves) == before
        # As somebody does who hopes that it helps.
        guard.hidden_axial_n = None
        guard.in_part_frame = guard.gravity_compensated = False
        await died.restart()


async def test_a_start_tells_of_an_arm_that_a_held_part_has_kept_in_its_place(
    died: DaemonRig, tmp_path: Path
) -> None:
    bench, guard = died.bench, died.bench.cell.guard
    bench.cell.zero_folder = tmp_path / "zeros"
    await died.open()
    noisy(guard)
    guard.trip = GuardTrip(TripReason.FILTERED_LIMIT, 1.0, "Fz -50.3 N, limit 50.00 N", 2, -50.3)
    bench.cell.main.road_is_free = asyncio.Event()
    bench.cell.main.on_the_way.clear()
    guard_acknowledge = guard.acknowledge

    async def stays_tripped() -> None:
        trip = guard.trip
        await guard_acknowledge()
        guard.trip = trip

    guard.acknowledge = stays_tripped  # type: ignore[method-assign]
    assert await died.take(Command.RESET) is RejectCode.NONE
    await died.until(lambda: bench.cell.main.stops > 0)
    bench.cell.main.road_is_free.set()
    await died.to(State.ABORTED)
    guard.trip, moves = None, len(bench.cell.main.moves)
    await died.restart()
    (told,) = [one for one in died.unit.alarms.active if one.number == PartLeftInPlace.number]
    x_mm, y_mm, z_mm = bench.cell.main.flange.translation * 1e3
    assert f"main at {x_mm:.1f} {y_mm:.1f} {z_mm:.1f} mm" in told.text
    assert "force: pressed with " in told.text
    assert "something held it: " in told.text
    assert "Fz -50.3 N" in told.text
    assert "now main at" in told.text
    assert len(bench.cell.main.moves) == moves


async def test_a_start_after_the_arm_has_left_tells_nothing(
    died: DaemonRig, tmp_path: Path
) -> None:
    died.bench.cell.zero_folder = tmp_path / "zeros"
    await died.open()
    noisy(died.bench.cell.guard)
    await died.idle()
    await died.restart()
    assert PartLeftInPlace.number not in died.unit.alarms.numbers
