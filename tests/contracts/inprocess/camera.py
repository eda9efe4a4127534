"""A single camera in memory."""

import asyncio

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from tests.wire.cameras.camera_bench import pixels


class InProcessCamera(Camera):
    """A ramp that shifts with each exposure."""

    def __init__(self, name: str, pixel_format: PixelFormat) -> None:
        self.name = name
        self.exposures = 0
        self.silent = self.cut = False
        self._pixel_format = pixel_format
        self._connected = False

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._connected = False

    async def serial_number(self) -> str:
        self._check()
        return "MEMORY-1"

    async def grab(self) -> CameraImage:
        self._check()
        if self.cut:
            self.cut = self._connected = False
            raise LinkLost(self.name)
        if self.silent:
            self.silent = False
            await asyncio.sleep(0.1)
            raise ReplyTimeout(self.name)
        self.exposures += 1
        array = pixels(self._pixel_format, self.exposures)
        return CameraImage(array, self._pixel_format, now_s(), self.exposures)

    def _check(self) -> None:
        if not self._connected:
            raise LinkLost(self.name)
