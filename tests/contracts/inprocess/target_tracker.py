"""A large-field head in memory."""

import asyncio

from cellctl.errors.link import ProtocolViolation, ReplyTimeout
from cellctl.geometry.pose import Array
from cellctl.interfaces.target_tracker import Target, TargetTracker
from tests.contracts.inprocess.link import InProcessLink


class InProcessTracker(InProcessLink, TargetTracker):
    """Sees the targets it is given, exactly."""

    def __init__(self, name: str, truth: dict[str, Array]) -> None:
        super().__init__(name)
        self.hidden: set[str] = set()
        self.silent = self.garbled = False
        self._truth = truth

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
