"""Whoever submitted a command hears of its end, and of no other one."""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass, field

import pytest

from cellctl.command.submission import Submission
from cellctl.command.tracker import CommandTracker
from cellctl.packml import Command, PackMLMachine, RejectCode, State
from cellctl.packml.result import Result
from cellctl.packml.unit_command import Source, UnitCommand


@dataclass(frozen=True, slots=True, eq=False)
class Heard(Submission):
    """Keeps what its client would hear."""

    ends: list[Result] = field(default_factory=list)

    def ended(self, result: Result) -> None:
        self.ends.append(result)


def asked(source: Source, command: Command, unit_mode: int = 0) -> Heard:
    return Heard(UnitCommand(source, cntrl_cmd=command, unit_mode=unit_mode))


async def forever() -> None:
    await asyncio.Event().wait()


class Rig:
    def __init__(self) -> None:
        self.machine = PackMLMachine({State.EXECUTE: forever}, initial=State.STOPPED)
        self.tracker = CommandTracker(self.machine, lambda: Result.BAD)

    async def execute(self, submission: Heard, *states: State) -> Heard:
        assert await self.tracker.execute(submission) is RejectCode.NONE
        await self.machine.wait_for(*states, timeout_s=1)
        return submission

    async def executing(self) -> Heard:
        """A Start of the line that does not end by itself."""
        await self.execute(asked(Source.LINE, Command.RESET), State.IDLE)
        return await self.execute(asked(Source.LINE, Command.START), State.EXECUTE)


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    rig = Rig()
    yield rig
    await rig.machine.close()


async def test_each_source_hears_how_its_own_command_ended(rig: Rig) -> None:
    start = await rig.executing()
    abort = await rig.execute(asked(Source.TERMINAL, Command.ABORT), State.ABORTED)
    assert start.ends == [Result.ABORTED]
    assert abort.ends == [Result.GOOD]


async def test_a_later_command_of_the_same_source_takes_the_place_of_the_earlier_one(
    rig: Rig,
) -> None:
    start = await rig.executing()
    stop = await rig.execute(asked(Source.LINE, Command.STOP), State.STOPPED)
    assert start.ends == []
    assert stop.ends == [Result.GOOD]


async def test_a_refused_command_takes_no_place(rig: Rig) -> None:
    start = await rig.executing()
    reset = asked(Source.LINE, Command.RESET)
    assert await rig.tracker.execute(reset) is RejectCode.COMMAND_NOT_ALLOWED
    await rig.machine.command(Command.COMPLETE)
    await rig.machine.wait_for(State.COMPLETED, timeout_s=1)
    assert start.ends == [Result.BAD], "the result of the run"
    assert reset.ends == []


async def test_a_command_that_is_refused_in_its_new_mode_leaves_the_mode(rig: Rig) -> None:
    mode = rig.machine.mode
    reset = asked(Source.LINE, Command.RESET, unit_mode=3)
    assert await rig.tracker.execute(reset) is RejectCode.STATE_NOT_IN_MODE
    assert rig.machine.mode is mode
