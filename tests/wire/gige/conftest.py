"""Two fake cameras behind the compiled producer, and what their drivers need."""

import asyncio
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivers.camera.gige.config import GigeCameraConfig, Selection
from drivers.camera.gige.driver import GigeCamera
from fakes.gentl.build import build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras

LEFT, RIGHT = "GL-1", "GR-2"


@pytest.fixture(scope="session")
def producer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake GenTL producer, compiled once."""
    return build_producer(tmp_path_factory.mktemp("producer"))


@pytest.fixture
def fakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeCameras]:
    """A network with two cameras."""
    cameras = [FakeCamera(LEFT, "left eye", 64, 48), FakeCamera(RIGHT, "right eye", 64, 48)]
    with FakeCameras(tmp_path / "cameras", cameras) as fakes:
        monkeypatch.setenv(ENVIRONMENT, str(fakes.path))
        yield fakes


async def descriptors(process: int) -> int:
    """What a process has open, without the images that are just on their way to the driver."""
    counts = []
    for _ in range(20):
        counts.append(len(os.listdir(f"/proc/{process}/fd")))
        await asyncio.sleep(0.01)
    return min(counts)


def camera(producer: Path, **settings: Any) -> GigeCamera:
    """A driver of the left camera; ``settings`` replace those that suit tests."""
    asked: dict[str, Any] = {
        "camera": Selection(serial_number=LEFT),
        "producers": (producer,),
        "exposure_s": 0.001,
        "image_timeout_s": 0.3,
    } | settings
    return GigeCamera("eye", GigeCameraConfig(**asked))
