"""Start of Production is refused when calibrations or the clock are not to be trusted."""

from collections.abc import Callable
from datetime import timedelta
from typing import cast

import pytest

from cellctl.calibration.store.envelope import read_calibration
from cellctl.clock import utc_now
from cellctl.errors.force import ForceLimitExceeded
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.calibrations import CONTACT_STIFFNESS, STEREO_HEAD_1
from cellctl.records.store import RunStore
from tests.unit.cell.bench import Head
from tests.unit.daemon_rig import DaemonRig


async def test_a_blow_costs_the_calibrations_that_it_may_have_spoilt(rig: DaemonRig) -> None:
    await rig.idle()
    assert rig.shown().calibration_ok
    await rig.unit.machine.fail(ForceLimitExceeded("Fx 812 N"))
    await rig.to(State.ABORTED)
    await rig.unit.background.drain()
    await rig.idle()
    assert not rig.shown().calibration_ok
    assert await rig.take(Command.START) is RejectCode.CALIBRATION_INVALID
    await rig.restart()
    await rig.idle()
    assert await rig.take(Command.START) is RejectCode.CALIBRATION_INVALID


async def test_a_figure_that_only_replaces_a_bound_stops_production_when_it_is_declared_wrong(
    rig: DaemonRig,
) -> None:
    await rig.idle()
    calibrations = rig.bench.calibrations
    calibrations.store(CONTACT_STIFFNESS.for_recipe(1), {"verdict": "pass"}, "", timedelta(days=1))
    assert rig.shown().ready
    calibrations.invalidate([CONTACT_STIFFNESS], "fingers exchanged")
    assert not rig.shown().ready
    assert await rig.take(Command.START) is RejectCode.CALIBRATION_INVALID
    for file in calibrations.path.glob("contact_stiffness_1.*"):
        file.unlink()
    assert rig.shown().ready, "never made: the bounds of the recipe count"
    assert await rig.take(Command.START) is RejectCode.NONE
    await rig.to(State.COMPLETED)


async def test_a_blow_that_cannot_be_written_down_is_a_fault_of_its_own(rig: DaemonRig) -> None:
    for kind in ("payload", "board_transfer"):
        (rig.bench.calibrations.path / f"{kind}.invalidated.json.part").mkdir()
    await rig.unit.machine.fail(ForceLimitExceeded("Fx 812 N"))
    await rig.unit.background.drain()
    assert 634 in rig.shown().alarms


async def test_a_clock_behind_the_records_is_not_believed(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.idle()
    later = utc_now() + timedelta(days=30)
    with monkeypatch.context() as patch:
        patch.setattr(RunStore, "newest_time", lambda _: later)
        assert await rig.take(Command.START) is RejectCode.CALIBRATION_INVALID
    assert await rig.take(Command.START) is RejectCode.NONE
    await rig.to(State.COMPLETED)


def _invalidated(rig: DaemonRig) -> None:
    rig.bench.calibrations.invalidate([STEREO_HEAD_1], "the head was hit")


def _made_again(rig: DaemonRig) -> None:
    calibrations = rig.bench.calibrations
    was = read_calibration(calibrations.path, STEREO_HEAD_1.name)
    calibrations.store(STEREO_HEAD_1, was.record, was.serial_number, timedelta(days=9))


def _head_exchanged(rig: DaemonRig) -> None:
    cast(Head, rig.bench.cell.heads[0].camera).serial = "another head"


def _overridden(rig: DaemonRig) -> None:
    rig.bench.cell.main.looks["speed_override_ratio"] = 0.3


@pytest.mark.parametrize(
    ("happens", "fault"),
    [(_invalidated, 635), (_made_again, 631), (_head_exchanged, 631), (_overridden, 309)],
)
async def test_what_a_run_was_prepared_with_is_looked_at_again_after_a_hold(
    rig: DaemonRig, happens: Callable[[DaemonRig], None], fault: int
) -> None:
    await rig.started(options=2)
    await rig.to(State.HELD)
    happens(rig)
    main = rig.bench.cell.main
    moves = len(main.moves)
    await rig.take(Command.UNHOLD)
    await rig.until(lambda: State.UNHOLDING in rig.states)
    # With single step a run that goes on is held again before its second step.
    assert await rig.to(State.HELD, State.STOPPED, State.ABORTED) is not State.HELD
    await rig.to(State.STOPPED, State.ABORTED)
    record = await rig.record()
    assert record.head.fault_number == fault
    assert record.head.result != "good"
    assert len(main.moves) == moves, "nothing moves before it is known"
