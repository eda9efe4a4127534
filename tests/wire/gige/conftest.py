"""Two fake cameras behind the compiled producer, and what their drivers need."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivers.camera.gige.config import GigeCameraConfig, Selection
from drivers.camera.gige.driver import GigeCamera, GigeDevice
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras
from tests.rigs.wire.producer import built_once

LEFT, RIGHT = "GL-1", "GR-2"


@pytest.fixture(scope="session")
def producer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake GenTL producer, compiled once."""
    return built_once(tmp_path_factory)


@pytest.fixture
def fakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeCameras]:
    """A network with two cameras."""
    cameras = [FakeCamera(LEFT, "left eye", 64, 48), FakeCamera(RIGHT, "right eye", 64, 48)]
    with FakeCameras(tmp_path / "cameras", cameras) as fakes:
        monkeypatch.setenv(ENVIRONMENT, str(fakes.path))
        yield fakes


async def descriptors(device: GigeDevice, process: int) -> int:
    """What a device's library process has open, once the images before are on their way."""
    # Answered one after the other: what was sent before this answer is closed there.
    await device.set_exposure(0.001)
    return len(os.listdir(f"/proc/{process}/fd"))


def ended(process: int) -> bool:
    """Whether a process runs no more; nobody need have waited for it."""
    try:
        state = Path(f"/proc/{process}/stat").read_text("ascii").rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return True
    return state in {"Z", "X"}


def camera(producer: Path, **settings: Any) -> GigeCamera:
    """A driver of the left camera; ``settings`` replace those that suit tests."""
    asked: dict[str, Any] = {
        "camera": Selection(serial_number=LEFT),
        "producers": (producer,),
        "exposure_s": 0.001,
        "image_timeout_s": 10.0,
    } | settings
    return GigeCamera("eye", GigeCameraConfig(**asked))
