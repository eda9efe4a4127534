"""The jobs of `make soak-cameras`, a few times each, and the scales they are weighed on."""

import os
from pathlib import Path

import pytest

from benchmarks.cameras.kept import Kept, kept
from benchmarks.cameras.soak import SERIAL, soak_grabs, soak_openings, soak_pulls
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras


@pytest.fixture
def one_camera(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FakeCameras:
    fakes = FakeCameras(tmp_path / "soaked", [FakeCamera(SERIAL, width=64, height=48)])
    monkeypatch.setenv(ENVIRONMENT, str(fakes.path))
    return fakes


async def test_openings(producer: Path, one_camera: FakeCameras) -> None:
    done = await soak_openings(producer, one_camera, 5)
    assert done.clean, done
    assert one_camera.exposures(SERIAL) == 5


async def test_cable_pulls(producer: Path, one_camera: FakeCameras) -> None:
    done = await soak_pulls(producer, one_camera, 5)
    assert done.clean, done


async def test_images(producer: Path, one_camera: FakeCameras) -> None:
    done = await soak_grabs(producer, one_camera, 200)
    assert done.clean, done
    assert done.library is not None
    assert done.library[0].threads > 0


def test_what_is_kept_is_seen() -> None:
    before = kept(os.getpid())
    descriptor = os.open("/dev/null", os.O_RDONLY)
    after = kept(os.getpid())
    os.close(descriptor)
    assert after.outgrows(before)
    assert not before.outgrows(before)
    assert Kept(1, 1, 50_000).outgrows(Kept(1, 1, 1_000))
    assert Kept(1, 3, 1_000).outgrows(Kept(1, 1, 1_000))
