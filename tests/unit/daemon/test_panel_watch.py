"""What a robot reports of its panel while it stands is a fault at once, not at its next move."""

import asyncio
from typing import Any

import pytest

from cellctl.daemon.panel_watch import PanelWatch
from cellctl.errors.link import StaleData
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import RobotMode
from cellctl.packml.command import Command
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.unit_command import Options
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig, PaperPort

PRESSED = {"emergency_stop": True}


def watch(rig: DaemonRig) -> PanelWatch:
    return PanelWatch(rig.bench.as_cell, rig.unit)


async def in_contact(rig: DaemonRig) -> None:
    """The deck stands on the frame, and nothing moves until the test lets it."""
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()


class Port(PaperPort):
    async def failed(self) -> None:
        await asyncio.Event().wait()


async def test_an_emergency_stop_of_150_ms_in_contact_aborts_the_run(rig: DaemonRig) -> None:
    await in_contact(rig)
    daemon = asyncio.create_task(rig.supervision(Port()))
    rig.bench.cell.main.looks = PRESSED
    await asyncio.sleep(0.15)
    rig.bench.cell.main.looks = {}
    await rig.to(State.ABORTED)
    daemon.cancel()
    assert (await rig.record()).head.fault_number == 303
    (alarm,) = await rig.archive.do(RunStore.active_alarms)
    assert "main, while it stood: emergency stop" in alarm.text


async def test_a_button_that_is_released_by_the_next_look_is_told(rig: DaemonRig) -> None:
    await in_contact(rig)
    panels = watch(rig)
    rig.bench.cell.aux_1.looks = PRESSED
    await panels.look()
    assert rig.unit.machine.state is State.EXECUTE, "a move that it ended tells its own end first"
    rig.bench.cell.aux_1.looks = {}
    await panels.look()
    await rig.to(State.ABORTED)
    assert (await rig.record()).head.fault_number == 303


@pytest.mark.parametrize(
    ("looks", "number"),
    [
        ({"mode": RobotMode.MANUAL}, 303),
        ({"drives_on": False}, 303),
        ({"error_code": 5, "error_words": "5 (axis 3)"}, 307),
    ],
)
async def test_key_drives_and_error_of_an_arm_that_stands_abort_a_run(
    rig: DaemonRig, looks: dict[str, Any], number: int
) -> None:
    await in_contact(rig)
    panels = watch(rig)
    rig.bench.cell.main.looks = looks
    await panels.look()
    await panels.look()
    await rig.to(State.ABORTED)
    assert (await rig.record()).head.fault_number == number


@pytest.mark.parametrize(
    "looks",
    [
        {},
        {"stop_latched": True},  # the guard's touch
        PRESSED | {"moving": True},  # the move tells it
    ],
)
async def test_what_belongs_to_a_move_is_left_to_it(rig: DaemonRig, looks: dict[str, Any]) -> None:
    await in_contact(rig)
    panels = watch(rig)
    rig.bench.cell.main.looks = looks
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.EXECUTE
    rig.bench.cell.main.looks = {}
    rig.contact.may_end.set()
    await rig.to(State.COMPLETED)


LATCHED = {"stop_latched": True, "unasked_latch": "no heartbeat for 0.6 s"}


async def test_a_latch_that_nobody_has_asked_for_aborts_the_run_at_once(rig: DaemonRig) -> None:
    await in_contact(rig)
    daemon = asyncio.create_task(rig.supervision(Port()))
    await asyncio.sleep(0.15)
    rig.bench.cell.main.looks = LATCHED
    await rig.to(State.ABORTED)
    daemon.cancel()
    assert (await rig.record()).head.fault_number == 306
    (alarm,) = await rig.archive.do(RunStore.active_alarms)
    assert "main, while it stood: no heartbeat for 0.6 s" in alarm.text


async def test_it_is_told_of_a_held_run_and_in_maintenance_too(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await rig.started(options=Options.SINGLE_STEP)
    await rig.to(State.HELD)
    monkeypatch.setattr(type(rig.unit.machine), "mode", Mode.MAINTENANCE)
    panels = watch(rig)
    await panels.look()
    rig.bench.cell.aux_1.looks = LATCHED
    await panels.look()
    await panels.look()
    await rig.to(State.ABORTED)


async def test_a_latch_of_one_look_is_a_touch_that_the_guard_has_not_told_yet(
    rig: DaemonRig,
) -> None:
    await in_contact(rig)
    panels = watch(rig)
    await panels.look()
    rig.bench.cell.main.looks = LATCHED
    await panels.look()
    rig.bench.cell.main.looks = {}
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.EXECUTE
    # Nor is one for which the guard has a reason.
    rig.bench.cell.main.looks = LATCHED
    rig.bench.cell.guard.trip = GuardTrip(TripReason.TOUCH, 1.0, "Fz 12.0 N", 2, 12.0)
    await panels.look()
    await panels.look()
    # Whoever goes on releases the guard first, and the arm may take its time.
    rig.bench.cell.guard.trip = None
    for _ in range(3):
        await panels.look()
    assert rig.unit.machine.state is State.EXECUTE
    rig.bench.cell.main.looks = {}
    rig.contact.may_end.set()
    await rig.to(State.COMPLETED)


async def test_a_reset_may_take_its_time_to_release_what_was_latched_before(
    rig: DaemonRig,
) -> None:
    # An emergency stop at rest, or a link that was lost before Clear, has left the latch.
    await in_contact(rig)
    panels = watch(rig)
    rig.bench.cell.main.looks = LATCHED
    for _ in range(5):
        await panels.look()
    assert rig.unit.machine.state is State.EXECUTE
    rig.bench.cell.main.looks = {}
    await panels.look()
    rig.bench.cell.main.looks = LATCHED
    await panels.look()
    await panels.look()
    await rig.to(State.ABORTED)


async def test_a_link_that_is_lost_is_not_told_twice(rig: DaemonRig) -> None:
    await in_contact(rig)
    panels = watch(rig)
    rig.bench.cell.main.faults["state"] = StaleData("2 s")
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.EXECUTE


async def test_at_rest_a_pressed_button_refuses_start_and_is_no_fault(rig: DaemonRig) -> None:
    await rig.idle()
    panels = watch(rig)
    rig.bench.cell.main.looks = PRESSED
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.IDLE


async def test_in_maintenance_only_the_emergency_stop_counts(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    await in_contact(rig)
    panels = watch(rig)
    monkeypatch.setattr(type(rig.unit.machine), "mode", Mode.MAINTENANCE)
    rig.bench.cell.main.looks = {"mode": RobotMode.MANUAL, "drives_on": False}
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.EXECUTE, "somebody jogs the arm for a procedure"
    rig.bench.cell.main.looks = PRESSED
    await panels.look()
    await panels.look()
    await rig.to(State.ABORTED)


async def test_a_held_run_may_be_jogged_and_not_pressed(rig: DaemonRig) -> None:
    await rig.started(options=Options.SINGLE_STEP)
    await rig.to(State.HELD)
    panels = watch(rig)
    rig.bench.cell.main.looks = {"mode": RobotMode.MANUAL, "drives_on": False}
    await panels.look()
    await panels.look()
    assert rig.unit.machine.state is State.HELD
    rig.bench.cell.main.looks = PRESSED
    await panels.look()
    await panels.look()
    await rig.to(State.ABORTED)
    assert await rig.take(Command.CLEAR) is RejectCode.NONE
