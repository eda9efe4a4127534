"""A large-field head in memory."""

import asyncio

from cellctl.errors.link import LinkLost, ProtocolViolation, ReplyTimeout
from cellctl.geometry.pose import Array
from cellctl.interfaces.target_tracker import Target, TargetTracker


class InProcessTracker(TargetTracker):
    """Sees the targets it is given, exactly."""

    def __init__(self, name: str, truth: dict[str, Array]) -> None:
        self.name = name
        self.hidden: set[str] = set()
        self.silent = self.garbled = False
        self._truth = truth
        self._connected = False

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._connected = False

    async def serial_number(self) -> str:
        self._check()
        return "MEMORY-1"

    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        self._check()
        if self.silent:
            self.silent = False
            await asyncio.sleep(0.1)
            raise ReplyTimeout(self.name)
        if self.garbled:
            self.garbled = False
            raise ProtocolViolation(self.name)
        seen = self._truth.keys() - self.hidden
        return tuple(Target(name, self._truth[name], 3e-5) for name in sorted(seen))

    def _check(self) -> None:
        if not self._connected:
            raise LinkLost(self.name)
