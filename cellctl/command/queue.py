"""Commands of the line that wait to be taken: Stop and Abort go before all others."""

import asyncio
from collections import deque

from cellctl.packml.unit_command import UnitCommand


class Intake:
    """In order of arrival; what stood before a Stop or an Abort is never taken after it."""

    def __init__(self, limit: int) -> None:
        """``limit``: so many commands wait; Stop and Abort always find room."""
        self._limit = limit
        self._waiting: deque[UnitCommand] = deque()
        self._urgent: deque[UnitCommand] = deque()
        self._overtaken: list[UnitCommand] = []
        self._changed = asyncio.Event()

    def add(self, command: UnitCommand) -> UnitCommand | None:
        """Let a command wait; the oldest one when there was no room for both."""
        dropped = None
        if command.ends_motion:
            self._urgent.append(command)
            self._overtaken.extend(self._waiting)
            self._waiting.clear()
        else:
            if len(self._waiting) == self._limit:
                dropped = self._waiting.popleft()
            self._waiting.append(command)
        self._changed.set()
        return dropped

    def overtaken(self) -> list[UnitCommand]:
        """What a Stop or an Abort has overtaken since the last call, the oldest first."""
        overtaken, self._overtaken = self._overtaken, []
        return overtaken

    async def next(self) -> UnitCommand:
        """The next command, taken out."""
        while not (self._urgent or self._waiting):
            await self._changed_again()
        return self._urgent.popleft() if self._urgent else self._waiting.popleft()

    async def urgent(self) -> None:
        """Wait until a Stop or an Abort waits."""
        while not self._urgent:
            await self._changed_again()

    async def _changed_again(self) -> None:
        self._changed.clear()
        await self._changed.wait()
