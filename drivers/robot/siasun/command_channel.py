"""The CMD channel of one robot: sequence numbers, answers, and one command at a time."""

import asyncio
from collections.abc import Callable
from typing import TypeVar

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, ProtocolViolation, ReplyTimeout
from cellctl.errors.robot import MotionRejected
from drivers.robot.siasun import faults
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.connection import SjlChannel
from drivers.robot.siasun.records import (
    Aborted,
    Ack,
    Answer,
    Done,
    Duplicate,
    Record,
    Rejected,
    Six,
)

Expected = TypeVar("Expected", Ack, Done)


class CommandChannel:
    """Sends a command and waits for its end; ``fail`` ends that wait from elsewhere."""

    def __init__(
        self, robot: str, config: SiasunConfig, on_lost: Callable[[LinkError], None]
    ) -> None:
        self.channel = SjlChannel(
            "CMD",
            config.robot_name,
            max_deadman_s=config.max_deadman_s,
            on_up=self._up,
            on_record=self._take,
            on_lost=on_lost,
        )
        self._robot = robot
        self._reply_timeout_s = config.reply_timeout_s
        self._seq = 0
        self._answers: asyncio.Queue[Answer | CellError] | None = None

    @property
    def running(self) -> bool:
        """A command waits for its end."""
        return self._answers is not None

    async def run(self, build: Callable[[int, int], bytes], timeout_s: float) -> Six:
        """Send ``build(session, seq)``; the flange pose at its end.

        Raises what the controller answered, what ``fail`` was given, or ``ReplyTimeout``. The
        channel is dropped when the controller is silent or its answer makes no sense.
        """
        if self._answers is not None:
            raise MotionRejected(f"{self._robot}: another motion is running")
        self._answers = asyncio.Queue()
        try:
            self._seq += 1
            self.channel.send(build(self.channel.session, self._seq))
            await self._expect(Ack, self._reply_timeout_s)
            done = await self._expect(Done, timeout_s)
        except (ReplyTimeout, ProtocolViolation) as fault:
            self.channel.drop(fault)
            raise
        finally:
            self._answers = None
        return done.flange_xyzabc

    def fail(self, fault: CellError) -> None:
        """End the running command, if any, with a fault."""
        if self._answers is not None:
            self._answers.put_nowait(fault)

    def _up(self) -> None:
        self._seq = 0

    def _take(self, record: Record) -> None:
        """Late answers to a command that was given up are passed over."""
        if not isinstance(record, Answer):
            raise ProtocolViolation(f"{self.channel}: {type(record).__name__} on this channel")
        if not 1 <= record.seq <= self._seq:
            raise ProtocolViolation(f"{self.channel}: {record} to a command that was never sent")
        if self._answers is not None and record.seq == self._seq:
            self._answers.put_nowait(record)

    async def _expect(self, kind: type[Expected], timeout_s: float) -> Expected:
        """The next answer, if it is of a kind; every other one is a fault."""
        assert self._answers is not None
        try:
            async with asyncio.timeout(timeout_s):
                answer = await self._answers.get()
        except TimeoutError:
            facts = f"{self._robot}: no {kind.__name__.upper()} within {timeout_s:g} s"
            raise ReplyTimeout(facts) from None
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
        return ProtocolViolation(f"{self._robot}: {answer} instead of {expected}")
