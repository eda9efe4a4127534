"""The contracts of the heads: in memory, and every driver against its wire fake."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import StereoCamera
from cellctl.interfaces.target_tracker import TargetTracker
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerHead
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from drivers.camera.target_server.config import TargetServerConfig
from drivers.camera.target_server.driver import TargetServerTracker
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.target_server import TargetServer
from fakes.world.targets import SeenTarget
from tests.contracts.inprocess.stereo_camera import InProcessHead
from tests.contracts.inprocess.target_tracker import InProcessTracker
from tests.contracts.suites.stereo_camera import StereoCameraBench, StereoCameraContract
from tests.contracts.suites.target_tracker import TargetTrackerContract, TrackerBench
from tests.wire.ramp import Ramp

TARGETS: dict[str, Array] = {
    "F1": np.array([0.0123456, 0.0, 5.98616]),
    "F2": np.array([-0.2, 0.1, 5.9]),
    "P1": np.array([0.4, -0.3, 6.0]),
}


class InProcessCameraBench(StereoCameraBench):
    def __init__(self) -> None:
        self.memory = InProcessHead("memory")
        self.camera: StereoCamera = self.memory

    def exposures(self) -> int:
        return self.memory.exposures

    def silence(self) -> None:
        self.memory.silent = True

    def cut(self) -> None:
        self.memory.cut = True


class FrameServerBench(StereoCameraBench):
    def __init__(self) -> None:
        self.pool = Ramp()
        self.server = FrameServer("127.0.0.1", 0, self.pool.scene, self.pool)

    async def start(self) -> None:
        await self.server.start()
        settings = FrameServerConfig(
            host="127.0.0.1", port=self.server.port, reply_timeout_s=0.3, connect_timeout_s=1.0
        )
        self.camera: StereoCamera = FrameServerHead("head_1", settings)

    def exposures(self) -> int:
        return self.pool.exposures

    def silence(self) -> None:
        self.server.faults.inject("silent", replies=1)

    def cut(self) -> None:
        self.server.faults.inject("hang_up", replies=1)


class GigeHeadBench(StereoCameraBench):
    def __init__(self, producer: Path, folder: Path) -> None:
        cameras = [FakeCamera(serial, width=64, height=48) for serial in ("GL", "GR")]
        self.fakes = FakeCameras(folder / "cameras", cameras)
        settings = GigeHeadConfig(
            left=Selection(serial_number="GL"),
            right=Selection(serial_number="GR"),
            producers=(producer,),
            exposure_s=0.001,
            image_timeout_s=1.0,
            max_difference_s=2.0,
        )
        self.camera: StereoCamera = GigeHead("head_1", settings)

    def exposures(self) -> int:
        return self.fakes.exposures("GL")

    def silence(self) -> None:
        self.fakes.inject("GR", "drop")

    def cut(self) -> None:
        self.fakes.inject("GL", "crash")


class InProcessTrackerBench(TrackerBench):
    truth = TARGETS

    def __init__(self) -> None:
        self.memory = InProcessTracker("memory", TARGETS)
        self.tracker: TargetTracker = self.memory

    def hide(self, name: str) -> None:
        self.memory.hidden.add(name)

    def silence(self) -> None:
        self.memory.silent = True

    def garble(self) -> None:
        self.memory.garbled = True


class TargetServerBench(TrackerBench):
    truth = TARGETS

    def __init__(self) -> None:
        self.server = TargetServer(self.measure)
        self.hidden: set[str] = set()

    async def start(self) -> None:
        settings = TargetServerConfig(
            host="127.0.0.1",
            port=await self.server.start(),
            reply_timeout_s=0.3,
            frame_timeout_s=0.0,
        )
        self.tracker: TargetTracker = TargetServerTracker("large_field", settings)

    async def measure(self, frames: int) -> tuple[SeenTarget, ...]:
        seen = TARGETS.keys() - self.hidden
        return tuple(SeenTarget(name, TARGETS[name], 3e-5) for name in sorted(seen))

    def hide(self, name: str) -> None:
        self.hidden.add(name)

    def silence(self) -> None:
        self.server.faults.inject("silent", count=1)

    def garble(self) -> None:
        self.server.faults.inject("malformed", count=1)


class TestInProcessHead(StereoCameraContract):
    @pytest.fixture
    async def bench(self) -> StereoCameraBench:
        return InProcessCameraBench()


class TestFrameServerHead(StereoCameraContract):
    driver = FrameServerHead

    @pytest.fixture
    async def bench(self) -> AsyncIterator[StereoCameraBench]:
        bench = FrameServerBench()
        await bench.start()
        yield bench
        await bench.camera.disconnect()
        if bench.server._client is not None:  # let it notice that its client has gone
            await asyncio.wait({bench.server._client}, timeout=2.0)
        await bench.server.stop()


class TestInProcessTracker(TargetTrackerContract):
    @pytest.fixture
    async def bench(self) -> TrackerBench:
        return InProcessTrackerBench()


class TestTargetServerTracker(TargetTrackerContract):
    driver = TargetServerTracker

    @pytest.fixture
    async def bench(self) -> AsyncIterator[TrackerBench]:
        bench = TargetServerBench()
        await bench.start()
        yield bench
        await bench.tracker.disconnect()
        await bench.server.stop()


class TestGigeHead(StereoCameraContract):
    """The driver with harvesters, genicam and a producer in C, each of them the real thing."""

    driver = GigeHead

    @pytest.fixture
    async def bench(
        self, producer: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> AsyncIterator[StereoCameraBench]:
        bench = GigeHeadBench(producer, tmp_path)
        monkeypatch.setenv(ENVIRONMENT, str(bench.fakes.path))
        yield bench
        await bench.camera.disconnect()
        bench.fakes.close()
