"""A device in memory that exposes: what cameras and heads share."""

import asyncio

from cellctl.errors.link import LinkLost, ReplyTimeout


class InProcessExposure:
    """``silent`` and ``cut`` hold for the next request."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.exposures = 0
        self.silent = self.cut = False
        self._connected = False

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._connected = False

    async def serial_number(self) -> str:
        self._check()
        return "MEMORY-1"

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

    def _check(self) -> None:
        if not self._connected:
            raise LinkLost(self.name)
