"""The line PLC is lost: what becomes of the unit in each state and at each step."""

import asyncio

import pytest

from cellctl.config.recipe import LineLostAction
from cellctl.errors.line import LineLost, LineLostInContact
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.runtime.progress import Progress
from tests.rigs.sweeps import sweep
from tests.unit.daemon_rig import DaemonRig

BEFORE_CONTACT, MATE, VERIFY = (10, 20, 30, 40), 50, 60


def choose(rig: DaemonRig, action: LineLostAction) -> None:
    cell = rig.bench.cell
    recipe = cell.config.recipes[0].model_copy(update={"line_lost_in_contact": action})
    cell.config = cell.config.model_copy(update={"recipes": (recipe,)})


def lose_line_at(rig: DaemonRig, step: int) -> None:
    """When the step is reached for the first time."""

    def seen(progress: Progress) -> None:
        if progress.step == step:
            rig.unit.board.observers.remove(seen)
            rig.unit.line_lost()

    rig.unit.board.observers.append(seen)


async def at_rest(rig: DaemonRig) -> None:
    """Nothing moves for many turns of the loop, and the unit stays where it is."""
    state, moves = rig.unit.machine.state, len(rig.bench.cell.main.moves)
    for _ in range(50):
        await asyncio.sleep(0)
    assert rig.unit.machine.state is state
    assert len(rig.bench.cell.main.moves) == moves


@pytest.mark.parametrize("step", sweep(BEFORE_CONTACT, BEFORE_CONTACT[:1]))
async def test_before_the_contact_it_holds(rig: DaemonRig, step: int) -> None:
    lose_line_at(rig, step)
    await rig.started()
    await rig.to(State.HELD)
    assert rig.shown().first_out_alarm == LineLost.number
    assert rig.contact.matings == 0
    assert [one.number for one in (await rig.record()).alarms] == [LineLost.number]
    await at_rest(rig)


async def test_in_starting_it_holds_before_the_first_step(rig: DaemonRig) -> None:
    await rig.idle()
    rig.bench.cell.main.road_is_free = asyncio.Event()
    await rig.take(Command.START)
    await rig.bench.cell.main.on_the_way.wait()
    assert rig.unit.machine.state is State.STARTING
    rig.unit.line_lost()
    await rig.until(lambda: LineLost.number in rig.shown().alarms)
    rig.bench.cell.main.road_is_free.set()
    await rig.to(State.HELD)
    assert rig.measurers[0].measured == []
    await at_rest(rig)


async def test_in_contact_it_stops_and_keeps_by_default(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    seq = await rig.started()
    await rig.contact.reached.wait()
    rig.unit.line_lost()
    await rig.to(State.ABORTED)
    main = rig.bench.cell.main
    assert rig.shown().first_out_alarm == LineLostInContact.number
    assert all(robot.latched for robot in rig.bench.cell.robots.values())
    assert main.flange is rig.contact.flange, "not backed off"
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("aborted", LineLostInContact.number)
    assert rig.port.ended[seq] is Result.ABORTED
    await at_rest(rig)


async def test_in_contact_it_backs_off_where_the_recipe_wants_that(rig: DaemonRig) -> None:
    choose(rig, LineLostAction.BACK_OFF)
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    rig.unit.line_lost()
    await rig.to(State.ABORTED)
    assert isinstance(rig.contact.interrupted_by, LineLostInContact)
    assert rig.shown().first_out_alarm == LineLostInContact.number
    assert (await rig.record()).head.result == "aborted"


async def test_a_contact_that_cannot_be_interrupted_is_stopped_instead(rig: DaemonRig) -> None:
    choose(rig, LineLostAction.BACK_OFF)
    rig.contact.interruptible = False
    lose_line_at(rig, MATE)
    rig.contact.may_end.clear()
    await rig.started()
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == LineLostInContact.number
    assert all(robot.latched for robot in rig.bench.cell.robots.values())


async def test_in_contact_it_finishes_where_the_recipe_wants_that(rig: DaemonRig) -> None:
    choose(rig, LineLostAction.FINISH)
    lose_line_at(rig, MATE)
    await rig.started()
    await rig.to(State.COMPLETED)
    assert (await rig.record()).head.result == "good"
    assert rig.shown().alarms == (LineLost.number,)


async def test_the_verification_is_finished(rig: DaemonRig) -> None:
    lose_line_at(rig, VERIFY)
    await rig.started()
    await rig.to(State.COMPLETED)
    assert (await rig.record()).head.result == "good"
    assert rig.shown().alarms == (LineLost.number,)


async def test_the_lift_off_of_a_reset_is_stopped(rig: DaemonRig) -> None:
    main = rig.bench.cell.main
    main.flange = rig.bench.flange_over_seat(0.0)
    main.road_is_free = asyncio.Event()
    assert await rig.take(Command.RESET) is RejectCode.NONE
    await main.on_the_way.wait()
    rig.unit.line_lost()
    await rig.to(State.STOPPED)
    assert rig.shown().first_out_alarm == LineLost.number
    assert main.latched
    assert len(main.moves) == 1
    await at_rest(rig)


async def test_what_is_suspended_is_held(rig: DaemonRig) -> None:
    await rig.idle()
    rig.bench.cell.main.road_is_free = asyncio.Event()
    await rig.take(Command.START)
    await rig.bench.cell.main.on_the_way.wait()
    rig.bench.cell.main.road_is_free.set()
    await rig.to(State.EXECUTE)
    await rig.take(Command.SUSPEND)
    await rig.to(State.SUSPENDED)
    rig.unit.line_lost()
    await rig.to(State.HELD)
    assert rig.shown().first_out_alarm == LineLost.number


@pytest.mark.parametrize("state", [State.STOPPED, State.IDLE, State.COMPLETED, State.ABORTED])
async def test_where_nothing_moves_it_is_an_alarm(rig: DaemonRig, state: State) -> None:
    if state is not State.STOPPED:
        await rig.idle()
    if state is State.COMPLETED:
        await rig.take(Command.START)
        await rig.to(state)
    if state is State.ABORTED:
        await rig.take(Command.ABORT)
        await rig.to(state)
    rig.unit.line_lost()
    await rig.until(lambda: LineLost.number in rig.shown().alarms)
    assert rig.unit.machine.state is state
    assert not rig.shown().error
