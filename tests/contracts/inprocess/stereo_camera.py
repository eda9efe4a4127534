"""A stereo head in memory."""

import asyncio

import numpy as np

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces.stereo_camera import StereoCamera, StereoPair


class InProcessHead(StereoCamera):
    """Grey ramps that shift with each exposure."""

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

    async def grab(self) -> StereoPair:
        self._check()
        if self.cut:
            self.cut = self._connected = False
            raise LinkLost(self.name)
        if self.silent:
            self.silent = False
            await asyncio.sleep(0.1)
            raise ReplyTimeout(self.name)
        self.exposures += 1
        ramp = np.add.outer(np.arange(4), np.arange(6)) + self.exposures
        left = ramp.astype(np.uint8)
        return StereoPair(left, left + np.uint8(100), now_s(), self.exposures)

    def _check(self) -> None:
        if not self._connected:
            raise LinkLost(self.name)
