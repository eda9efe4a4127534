"""The contract of the single camera: in memory, and every driver against its wire fake."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerCamera
from fakes.wire.cameras.image_server import ImageServer
from tests.contracts.camera import CameraContract, SingleCameraBench
from tests.contracts.inprocess.camera import InProcessCamera
from tests.wire.camera_bench import PictureTaker, pixels


class InProcessBench(SingleCameraBench):
    def __init__(self, pixel_format: PixelFormat) -> None:
        self.memory = InProcessCamera("memory", pixel_format)
        self.camera: Camera = self.memory
        self._pixel_format = pixel_format

    def truth(self) -> CameraImage:
        array = pixels(self._pixel_format, self.memory.exposures)
        return CameraImage(array, self._pixel_format, 0.0, self.memory.exposures)

    def exposures(self) -> int:
        return self.memory.exposures

    def silence(self) -> None:
        self.memory.silent = True

    def cut(self) -> None:
        self.memory.cut = True


class FrameServerBench(SingleCameraBench):
    def __init__(self, pixel_format: PixelFormat) -> None:
        self.taker = PictureTaker(pixel_format)
        self.server = ImageServer("127.0.0.1", 0, self.taker.take)

    async def start(self) -> None:
        await self.server.start()
        settings = FrameServerConfig(
            host="127.0.0.1", port=self.server.port, reply_timeout_s=0.3, connect_timeout_s=1.0
        )
        self.camera: Camera = FrameServerCamera("eye", settings)

    def truth(self) -> CameraImage:
        array = pixels(self.taker.pixel_format, self.taker.exposures)
        return CameraImage(array, self.taker.pixel_format, 0.0, self.taker.exposures)

    def exposures(self) -> int:
        return self.taker.exposures

    def silence(self) -> None:
        self.server.faults.inject("silent", replies=1)

    def cut(self) -> None:
        self.server.faults.inject("hang_up", replies=1)


class TestInProcessCamera(CameraContract):
    @pytest.fixture(params=PixelFormat, ids=lambda form: str(form.value))
    async def bench(self, request: pytest.FixtureRequest) -> SingleCameraBench:
        return InProcessBench(request.param)


class TestFrameServerCamera(CameraContract):
    driver = FrameServerCamera

    @pytest.fixture(params=PixelFormat, ids=lambda form: str(form.value))
    async def bench(self, request: pytest.FixtureRequest) -> AsyncIterator[SingleCameraBench]:
        bench = FrameServerBench(request.param)
        await bench.start()
        yield bench
        await bench.camera.disconnect()
        if bench.server._client is not None:  # let it notice that its client has gone
            await asyncio.wait({bench.server._client}, timeout=2.0)
        await bench.server.stop()
