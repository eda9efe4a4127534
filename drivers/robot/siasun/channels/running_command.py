"""A command that the controller works on: its answers, and the ticks of a stream."""

import asyncio
from collections.abc import Callable
from typing import TypeVar

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, ProtocolViolation, ReplyTimeout
from cellctl.errors.robot import MotionRejected
from drivers.robot.siasun import faults
from drivers.robot.siasun.codec.records import (
    Aborted,
    Ack,
    Answer,
    Done,
    Duplicate,
    Rejected,
    Six,
    Tick,
)

Expected = TypeVar("Expected", Ack, Done)


class RunningCommand:
    """One command from its sending to its end.

    ``session`` and ``seq`` are those of its record. ``give_up`` is called when the controller is
    silent or its answer makes no sense, before that is raised.
    """

    def __init__(
        self, robot: str, session: int, seq: int, give_up: Callable[[LinkError], None]
    ) -> None:
        self.session = session
        self.seq = seq
        self.over = False
        """The end is known, though perhaps nobody has asked for it yet."""
        self.tick: Tick | None = None
        """The newest tick, of a stream."""
        self.tick_time_s = 0.0
        """Monotonic time of its receipt."""
        self.news = asyncio.Event()
        """Set by every answer, fault and tick; whoever waits for it clears it."""
        self._robot = robot
        self._give_up = give_up
        self._answers: asyncio.Queue[Answer | CellError] = asyncio.Queue()

    def take(self, answer: Answer | CellError) -> None:
        """An answer of the controller, or a fault that ends the command from elsewhere."""
        self.over = self.over or not isinstance(answer, Ack)
        self._answers.put_nowait(answer)
        self.news.set()

    def take_tick(self, tick: Tick) -> None:
        """A tick of the controller; one that repeats or goes back is not news."""
        if self.tick is None or tick.number > self.tick.number:
            self.tick, self.tick_time_s = tick, now_s()
            self.news.set()

    async def acknowledged(self, timeout_s: float) -> None:
        """Wait until the controller accepts it; raises its refusal, or ``ReplyTimeout``."""
        await self._expect(Ack, timeout_s)

    async def done(self, timeout_s: float) -> Six:
        """Wait for the end and return the flange's pose there, in mm and degrees.

        Raises what ended the command early, or ``ReplyTimeout``.
        """
        return (await self._expect(Done, timeout_s)).flange_xyzabc

    def raise_end(self) -> None:
        """Raise what has ended a command that should still be running, if anything has."""
        if not self._answers.empty():
            raise self._fault(self._answers.get_nowait(), "TICK")

    async def _expect(self, kind: type[Expected], timeout_s: float) -> Expected:
        """The next answer, if it is of a kind; every other one is a fault."""
        try:
            async with asyncio.timeout(timeout_s):
                answer = await self._answers.get()
        except TimeoutError:
            fault = ReplyTimeout(
                f"{self._robot}: no {kind.__name__.upper()} within {timeout_s:g} s"
            )
            # Before it is raised: the answer may come later and would be taken for one to the next
            # command.
            self._give_up(fault)
            raise fault from None
        if isinstance(answer, kind):
            return answer
        raise self._fault(answer, kind.__name__.upper())

    def _fault(self, answer: Answer | CellError, expected: str) -> CellError:
        match answer:
            case CellError():
                return answer
            case Rejected(reason=reason):
                return faults.rejection(self._robot, reason)
            case Aborted(reason=reason):
                return faults.abortion(self._robot, reason)
            case Duplicate(seq=seq):
                return MotionRejected(f"{self._robot}: sequence number {seq} was used before")
        violation = ProtocolViolation(f"{self._robot}: {answer} instead of {expected}")
        self._give_up(violation)
        return violation
