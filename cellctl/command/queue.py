"""Commands of one client that wait to be submitted; Stop and Abort go before all others."""

import asyncio
from collections import deque
from typing import Generic, TypeVar

from cellctl.command.submission import Submission

S = TypeVar("S", bound=Submission)


class CommandQueue(Generic[S]):
    """Commands in order of arrival. What arrived before a Stop or an Abort is never taken after it.

    For clients that give commands without waiting for the answer to the one before, as a PLC does.
    """

    def __init__(self, limit: int) -> None:
        """``limit``: how many commands wait at most; Stop and Abort are not counted."""
        self._limit = limit
        self._waiting: deque[S] = deque()
        self._urgent: deque[S] = deque()
        self._overtaken: list[S] = []
        self._changed = asyncio.Event()

    def add(self, submission: S) -> S | None:
        """Let a command wait; returns the oldest one when it was dropped to make room."""
        dropped = None
        if submission.command.ends_motion:
            self._urgent.append(submission)
            # Not forgotten but handed out: each of them gets its answer, so that the PLC does not
            # wait for a number that is never acknowledged.
            self._overtaken.extend(self._waiting)
            self._waiting.clear()
        else:
            # The oldest one goes, not the newest: a client that sends so fast means the last.
            if len(self._waiting) == self._limit:
                dropped = self._waiting.popleft()
            self._waiting.append(submission)
        self._changed.set()
        return dropped

    def overtaken(self) -> list[S]:
        """What a Stop or an Abort has overtaken since the last call, the oldest first."""
        overtaken, self._overtaken = self._overtaken, []
        return overtaken

    async def next(self) -> S:
        """Wait for the next command and take it out."""
        while not (self._urgent or self._waiting):
            await self._changed_again()
        return self._urgent.popleft() if self._urgent else self._waiting.popleft()

    async def urgent(self) -> None:
        """Wait until a Stop or an Abort is in the queue; leaves it there."""
        while not self._urgent:
            await self._changed_again()

    async def _changed_again(self) -> None:
        self._changed.clear()
        await self._changed.wait()
