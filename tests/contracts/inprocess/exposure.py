"""A device in memory that exposes: what cameras and heads share."""

import asyncio

from cellctl.errors.link import LinkLost, ReplyTimeout
from tests.contracts.inprocess.link import InProcessLink


class InProcessExposure(InProcessLink):
    """``silent`` and ``cut`` hold for the next request."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.exposures = 0
        self.silent = self.cut = False

    async def _expose(self) -> int:
        """Number of the exposure; raises as a driver does that hears nothing or loses its link."""
        self._check()
        if self.cut:
            self.cut = self._connected = False
            raise LinkLost(self.name)
        if self.silent:
            self.silent = False
            await asyncio.sleep(0.1)
            raise ReplyTimeout(self.name)
        self.exposures += 1
        return self.exposures
