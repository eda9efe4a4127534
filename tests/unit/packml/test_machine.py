"""The machine with coroutines: holding, leaving, faults, order of commands."""

import asyncio
import functools
from collections.abc import AsyncIterator, Awaitable, Callable

import pytest

from cellctl.errors.base import CellError, Reaction
from cellctl.errors.internal import StateDidNotEnd, Unexpected
from cellctl.packml import Command, Mode, PackMLMachine, RejectCode, State

Action = Callable[[], Awaitable[None]]


class HoldError(CellError):
    reaction = Reaction.HOLD


class StopError(CellError):
    reaction = Reaction.STOP


class AbortError(CellError):
    reaction = Reaction.ABORT


class WarnError(CellError):
    reaction = Reaction.WARN


async def forever() -> None:
    await asyncio.Event().wait()


class Rig:
    """A machine whose history can be read; actions may be filled in before it is driven."""

    def __init__(self) -> None:
        self.actions: dict[State, Action] = {}
        self.history: list[State] = []
        self.reported: list[CellError] = []
        self.machines: list[PackMLMachine] = []

    def machine(self, **kwargs: object) -> PackMLMachine:
        machine = PackMLMachine(self.actions, leave_timeout_s=0.2, **kwargs)  # type: ignore[arg-type]
        machine.on_change.append(self._changed)
        machine.on_fault.append(self.reported.append)
        self.machines.append(machine)
        return machine

    def _changed(self, before: State, after: State) -> None:
        if before is not after:
            self.history.append(after)

    async def executing(self, action: Action) -> PackMLMachine:
        self.actions[State.EXECUTE] = action
        machine = self.machine(initial=State.STOPPED)
        await machine.command(Command.RESET)
        await machine.wait_for(State.IDLE, timeout_s=1)
        await machine.command(Command.START)
        await machine.wait_for(State.EXECUTE, timeout_s=1)
        return machine


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    rig = Rig()
    yield rig
    for machine in rig.machines:
        await machine.close()


async def test_a_cycle_from_aborted_to_completed(rig: Rig) -> None:
    machine = rig.machine()
    assert machine.state is State.ABORTED
    assert await machine.command(Command.CLEAR) is RejectCode.NONE
    await machine.wait_for(State.STOPPED, timeout_s=1)
    await machine.command(Command.RESET)
    await machine.wait_for(State.IDLE, timeout_s=1)
    await machine.command(Command.START)
    await machine.wait_for(State.COMPLETED, timeout_s=1)
    assert rig.history == [
        State.CLEARING, State.STOPPED, State.RESETTING, State.IDLE,
        State.STARTING, State.EXECUTE, State.COMPLETING, State.COMPLETED,
    ]  # fmt: skip


async def test_it_starts_only_where_nothing_moves(rig: Rig) -> None:
    with pytest.raises(ValueError, match="starts Aborted or Stopped"):
        PackMLMachine({}, initial=State.IDLE)
    with pytest.raises(ValueError, match="only wait"):
        PackMLMachine({State.IDLE: forever})


async def test_hold_waits_for_the_safe_point_and_execute_goes_on_where_it_was(rig: Rig) -> None:
    working, go_on = asyncio.Event(), asyncio.Event()
    held: list[bool] = []

    async def execute() -> None:
        working.set()
        await go_on.wait()
        held.append(await machine.safe_point())
        held.append(await machine.safe_point())

    machine = await rig.executing(execute)
    await working.wait()
    assert await machine.command(Command.HOLD) is RejectCode.NONE
    assert machine.state is State.EXECUTE
    assert machine.hold_requested
    assert machine.state_requested is State.HELD
    go_on.set()
    await machine.wait_for(State.HELD, timeout_s=1)
    assert held == []
    assert not machine.hold_requested
    await machine.command(Command.UNHOLD)
    await machine.wait_for(State.COMPLETED, timeout_s=1)
    assert held == [True, False]


async def test_suspend_pauses_likewise_and_hold_outranks_it(rig: Rig) -> None:
    go_on = asyncio.Event()

    async def execute() -> None:
        await go_on.wait()
        await machine.safe_point()

    machine = await rig.executing(execute)
    await machine.command(Command.HOLD)
    await machine.command(Command.SUSPEND)
    assert machine.state_requested is State.HELD
    go_on.set()
    await machine.wait_for(State.HELD, timeout_s=1)


async def test_a_held_sequence_is_cancelled_by_stop(rig: Rig) -> None:
    ended = asyncio.Event()

    go_on = asyncio.Event()

    async def execute() -> None:
        try:
            await go_on.wait()
            await machine.safe_point()
        finally:
            ended.set()

    machine = await rig.executing(execute)
    await machine.command(Command.HOLD)
    go_on.set()
    await machine.wait_for(State.HELD, timeout_s=1)
    await machine.command(Command.STOP)
    await machine.wait_for(State.STOPPED, timeout_s=1)
    assert ended.is_set()


async def test_abort_cancels_at_once_and_aborting_does_not_wait_to_act(rig: Rig) -> None:
    order: list[str] = []
    started = asyncio.Event()

    async def execute() -> None:
        started.set()
        try:
            await forever()
        finally:
            await stopped.wait()
            order.append("execute cleaned up")

    stopped = asyncio.Event()

    async def aborting() -> None:
        order.append("robots stopped")
        stopped.set()

    rig.actions[State.ABORTING] = aborting
    machine = await rig.executing(execute)
    await started.wait()
    await machine.command(Command.ABORT)
    await machine.wait_for(State.ABORTED, timeout_s=1)
    assert order == ["robots stopped", "execute cleaned up"]


async def test_stopping_begins_at_once_and_ends_after_the_left_sequence(rig: Rig) -> None:
    order: list[str] = []
    started = asyncio.Event()

    async def execute() -> None:
        started.set()
        try:
            await forever()
        finally:
            await asyncio.sleep(0)
            order.append("execute")

    async def stopping() -> None:
        order.append("stopping")

    rig.actions[State.STOPPING] = stopping
    machine = await rig.executing(execute)
    await started.wait()
    await machine.command(Command.STOP)
    await machine.wait_for(State.STOPPED, timeout_s=1)
    assert order == ["stopping", "execute"]


@pytest.mark.parametrize("command", [Command.STOP, Command.ABORT])
async def test_the_fault_of_the_stop_is_not_lost_to_one_of_what_was_left(
    rig: Rig, command: Command
) -> None:
    started = asyncio.Event()

    async def execute() -> None:
        started.set()
        try:
            await forever()
        finally:
            raise WarnError("left behind")

    async def stop() -> None:
        raise AbortError("the arm still moves")

    rig.actions |= {State.STOPPING: stop, State.ABORTING: stop}
    machine = await rig.executing(execute)
    await started.wait()
    await machine.command(command)
    await machine.wait_for(State.ABORTED, timeout_s=1)
    assert "the arm still moves" in str(machine.fault)


@pytest.mark.parametrize(
    ("error", "end"),
    [
        (HoldError("x"), State.HELD),
        (StopError("x"), State.STOPPED),
        (WarnError("x"), State.STOPPED),
        (AbortError("x"), State.ABORTED),
        (RuntimeError("x"), State.ABORTED),
    ],
)
async def test_what_goes_wrong_in_execute_leads_by_its_reaction(
    rig: Rig, error: Exception, end: State
) -> None:
    async def execute() -> None:
        raise error

    machine = await rig.executing(execute)
    await machine.wait_for(end, timeout_s=1)
    assert machine.fault is not None
    assert rig.reported == [machine.fault]
    if isinstance(error, RuntimeError):
        assert isinstance(machine.fault, Unexpected)
        assert machine.fault.__cause__ is error


async def test_a_hold_fault_where_hold_is_impossible_stops(rig: Rig) -> None:
    async def resetting() -> None:
        raise HoldError("x")

    rig.actions[State.RESETTING] = resetting
    machine = rig.machine(initial=State.STOPPED)
    await machine.command(Command.RESET)
    await machine.wait_for(State.STOPPED, timeout_s=1)
    assert rig.history == [State.RESETTING, State.STOPPING, State.STOPPED]


async def test_after_a_hold_fault_execute_begins_anew(rig: Rig) -> None:
    runs: list[int] = []

    async def execute() -> None:
        runs.append(len(runs))
        if len(runs) == 1:
            raise HoldError("measure again")

    machine = await rig.executing(execute)
    await machine.wait_for(State.HELD, timeout_s=1)
    await machine.command(Command.UNHOLD)
    assert machine.fault is None
    await machine.wait_for(State.COMPLETED, timeout_s=1)
    assert runs == [0, 1]


async def test_faults_latch_until_clear_and_the_first_counts(rig: Rig) -> None:
    first, second = AbortError("first"), AbortError("second")

    async def execute() -> None:
        raise first

    async def aborting() -> None:
        raise second

    rig.actions[State.ABORTING] = aborting
    machine = await rig.executing(execute)
    await machine.wait_for(State.ABORTED, timeout_s=1)
    assert machine.faults == (first, second)
    assert machine.fault is first
    assert await machine.command(Command.RESET) is RejectCode.COMMAND_NOT_ALLOWED
    assert machine.fault is first
    await machine.command(Command.CLEAR)
    assert machine.fault is None


async def test_a_sequence_that_does_not_end_is_a_fault_and_aborting_still_ends(rig: Rig) -> None:
    release, started = asyncio.Event(), asyncio.Event()

    async def execute() -> None:
        started.set()
        while not release.is_set():
            try:
                await release.wait()
            except asyncio.CancelledError:
                continue

    machine = await rig.executing(execute)
    await started.wait()
    await machine.command(Command.ABORT)
    await machine.wait_for(State.ABORTED, timeout_s=2)
    assert isinstance(machine.fault, StateDidNotEnd)
    release.set()


async def test_a_failed_clean_up_turns_stopping_into_aborting(rig: Rig) -> None:
    started = asyncio.Event()

    async def execute() -> None:
        started.set()
        try:
            await forever()
        finally:
            raise AbortError("robot did not stop")

    machine = await rig.executing(execute)
    await started.wait()
    await machine.command(Command.STOP)
    await machine.wait_for(State.ABORTED, timeout_s=1)
    assert isinstance(machine.fault, AbortError)


async def test_a_command_is_validated_again_when_its_turn_comes(rig: Rig) -> None:
    machine = rig.machine(initial=State.STOPPED)
    codes = await asyncio.gather(machine.command(Command.RESET), machine.command(Command.RESET))
    assert sorted(codes) == [RejectCode.NONE, RejectCode.COMMAND_NOT_ALLOWED]
    assert machine.refusals[0].code is RejectCode.COMMAND_NOT_ALLOWED
    await machine.wait_for(State.IDLE, timeout_s=1)
    assert rig.history == [State.RESETTING, State.IDLE]


async def test_the_gate_refuses_what_the_tables_allow(rig: Rig) -> None:
    def gate(_state: State, command: Command) -> RejectCode:
        starts = command is Command.START
        return RejectCode.CALIBRATION_INVALID if starts else RejectCode.NONE

    machine = rig.machine(initial=State.STOPPED, gate=gate)
    await machine.command(Command.RESET)
    await machine.wait_for(State.IDLE, timeout_s=1)
    assert await machine.command(Command.START) is RejectCode.CALIBRATION_INVALID
    assert machine.state is State.IDLE


async def test_only_eight_refusals_are_kept(rig: Rig) -> None:
    machine = rig.machine()
    for number in range(20, 30):
        assert await machine.command(number) is RejectCode.COMMAND_UNDEFINED
    assert [refusal.request for refusal in machine.refusals] == [
        f"command {number}" for number in range(22, 30)
    ]


@pytest.mark.parametrize(
    ("error", "end"), [(AbortError("guard"), State.ABORTED), (StopError("x"), State.STOPPED)]
)
async def test_a_fault_from_outside_ends_the_run(rig: Rig, error: CellError, end: State) -> None:
    machine = await rig.executing(forever)
    await machine.fail(error)
    await machine.wait_for(end, timeout_s=1)
    assert machine.fault is error


async def test_a_hold_fault_from_outside_waits_for_the_safe_point(rig: Rig) -> None:
    ready = asyncio.Event()

    async def execute() -> None:
        await ready.wait()
        await machine.safe_point()

    machine = await rig.executing(execute)
    error = HoldError("line silent")
    await machine.fail(error)
    assert machine.state is State.EXECUTE
    ready.set()
    await machine.wait_for(State.HELD, timeout_s=1)
    assert machine.fault is error


async def test_a_hold_fault_while_nothing_runs_is_only_reported(rig: Rig) -> None:
    machine = rig.machine(initial=State.STOPPED)
    error = HoldError("line silent")
    await machine.fail(error)
    assert machine.state is State.STOPPED
    assert machine.fault is None
    assert rig.reported == [error]


async def test_modes_change_where_they_may(rig: Rig) -> None:
    machine = rig.machine(initial=State.STOPPED)
    assert await machine.set_mode(Mode.MAINTENANCE) is RejectCode.NONE
    assert machine.mode is Mode.MAINTENANCE
    assert await machine.set_mode(9) is RejectCode.MODE_NOT_CONFIGURED
    assert machine.mode is Mode.MAINTENANCE


async def test_the_heartbeat_stops_when_the_machine_is_stuck(rig: Rig) -> None:
    machine = rig.machine()
    beats: asyncio.Queue[int] = asyncio.Queue()
    beat = functools.partial(beats.put_nowait, 1)
    beating = asyncio.create_task(machine.beat_while_alive(beat, 0.001))
    async with asyncio.timeout(1):
        await beats.get()
        await beats.get()
    async with machine._turn:
        while not beats.empty():
            beats.get_nowait()
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(beats.get(), 0.05)
    await asyncio.wait_for(beats.get(), 1)
    beating.cancel()


async def test_wait_for_gives_up_in_time(rig: Rig) -> None:
    machine = rig.machine()
    with pytest.raises(TimeoutError):
        await machine.wait_for(State.IDLE, timeout_s=0.01)


@pytest.mark.parametrize("inside", [True, False])
async def test_an_observer_that_fails_does_not_keep_a_fault_from_stopping(
    rig: Rig, *, inside: bool
) -> None:
    breaks, stopping = asyncio.Event(), asyncio.Event()

    async def execute() -> None:
        await breaks.wait()
        raise AbortError("in the step")

    async def aborting() -> None:
        stopping.set()

    def disk_full(_: CellError) -> None:
        raise OSError("no space left")

    rig.actions[State.ABORTING] = aborting
    machine = await rig.executing(execute)
    machine.on_fault.insert(0, disk_full)
    if inside:
        breaks.set()
    else:
        with pytest.raises(OSError, match="no space"):
            await machine.fail(AbortError("of a device"))
    async with asyncio.timeout(1):
        await stopping.wait()
    machine.on_fault.clear()
    await machine.wait_for(State.ABORTED, timeout_s=1)
