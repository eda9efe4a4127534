"""The contract of the single camera: in memory, and every driver against its wire fake."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerCamera
from drivers.camera.gige.config import GigeCameraConfig, Selection
from drivers.camera.gige.driver import GigeCamera
from drivers.camera.gige.pixels import decoded
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras, expected_image
from fakes.gentl.formats import Format
from fakes.wire.cameras.image_server import ImageServer
from tests.contracts.inprocess.camera import InProcessCamera
from tests.contracts.suites.camera import CameraContract, SingleCameraBench
from tests.wire.cameras.camera_bench import CODES, PictureTaker, pixels


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

    @pytest.fixture(params=CODES, ids=lambda form: str(form.value))
    async def bench(self, request: pytest.FixtureRequest) -> AsyncIterator[SingleCameraBench]:
        bench = FrameServerBench(request.param)
        await bench.start()
        yield bench
        await bench.camera.disconnect()
        if bench.server._client is not None:  # let it notice that its client has gone
            await asyncio.wait({bench.server._client}, timeout=2.0)
        await bench.server.stop()


class GigeBench(SingleCameraBench):
    def __init__(self, producer: Path, folder: Path, pixel_format: Format) -> None:
        self.fakes = FakeCameras(
            folder / "cameras", [FakeCamera("G1", width=64, height=48, pixel_format=pixel_format)]
        )
        self._pixel_format = pixel_format
        settings = GigeCameraConfig(
            camera=Selection(serial_number="G1"),
            producers=(producer,),
            exposure_s=0.001,
            image_timeout_s=1.0,
        )
        self.camera: Camera = GigeCamera("eye", settings)

    def truth(self) -> CameraImage:
        drawn = expected_image(self.exposures(), 64, 48, self._pixel_format)
        data = np.ascontiguousarray(drawn).view(np.uint8).ravel()
        return CameraImage(*decoded(data, self._pixel_format, 64, 48), 0.0, self.exposures())

    def exposures(self) -> int:
        return self.fakes.exposures("G1")

    def silence(self) -> None:
        self.fakes.inject("G1", "drop")

    def cut(self) -> None:
        self.fakes.inject("G1", "crash")


@pytest.mark.long
class TestGigeCamera(CameraContract):
    """The driver with harvesters, genicam and a producer in C, each of them the real thing.

    Each test starts a process that loads them. A standard run tries the contract with heads.
    """

    driver = GigeCamera

    @pytest.fixture(params=["Mono8", "Mono12", "BayerRG8", "BayerRG12"])
    async def bench(
        self,
        request: pytest.FixtureRequest,
        producer: Path,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
    ) -> AsyncIterator[SingleCameraBench]:
        bench = GigeBench(producer, tmp_path, request.param)
        monkeypatch.setenv(ENVIRONMENT, str(bench.fakes.path))
        yield bench
        await bench.camera.disconnect()
        bench.fakes.close()
