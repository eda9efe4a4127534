"""Exposures of a run: found once by the light round the holes, in bounded tries and time."""

import asyncio
from types import SimpleNamespace
from typing import Any, cast

import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from cellctl.cell.devices import Cell
from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.clock import now_s
from cellctl.config import CellConfig
from cellctl.config.checks.cross_checks import cross_issues
from cellctl.config.devices import AutoExposureConfig
from cellctl.errors.camera import ExposureNotAdjustable, ExposureNotReached
from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import Image, StereoPair
from cellctl.records.run_recorder import RunRecorder
from tests.contracts.inprocess.camera import InProcessCamera
from tests.contracts.inprocess.stereo_camera import InProcessHead
from tests.unit.cell.bench import InlineWorkers

HOLES = {"hole_px": (4.0, 12.0)}


def plate(grey: float) -> Image:
    """Three dark holes in a surface of this grey, clipped as a sensor does."""
    light = np.full((120, 160), grey, dtype=np.float32)
    for centre in ((40, 40), (110, 40), (70, 90)):
        cv2.circle(light, centre, 8, 0.05 * grey, -1)
    return np.clip(np.rint(cv2.GaussianBlur(light, (0, 0), 0.8)), 0, 255).astype(np.uint8)


class Head(InProcessHead):
    """Its right view is twice as bright as its left one."""

    def __init__(self, grey_a_ms: float = 40.0) -> None:
        super().__init__("head_1")
        self.exposure_s = 0.001
        self.grey_a_ms = grey_a_ms

    async def set_exposure(self, exposure_s: float) -> float:
        self.exposure_s = exposure_s
        return exposure_s

    async def grab(self) -> StereoPair:
        self.exposures += 1
        grey = self.grey_a_ms * self.exposure_s * 1e3
        one = ExposureRecord("L", "Mono8", 8, exposure_s=self.exposure_s)
        return StereoPair(plate(grey), plate(2 * grey), now_s(), self.exposures, (one, one))


class FlickeringHead(Head):
    """A head in a light that is never the same twice."""

    async def grab(self) -> StereoPair:
        self.grey_a_ms = 10.0 if self.grey_a_ms > 10.0 else 20.0
        return await super().grab()


class HangingHead(Head):
    """Takes its time."""

    async def grab(self) -> StereoPair:
        await asyncio.Event().wait()
        raise AssertionError


class DeepCamera(InProcessCamera):
    """A camera of 12 bits."""

    def __init__(self) -> None:
        super().__init__("eye", PixelFormat.MONO16)
        self.exposure_s = 0.002

    async def set_exposure(self, exposure_s: float) -> float:
        self.exposure_s = exposure_s
        return exposure_s

    async def grab(self) -> CameraImage:
        self.exposures += 1
        pixels = np.asarray(plate(50.0 * self.exposure_s * 1e3), dtype=np.uint16) << np.uint16(4)
        stated = ExposureRecord("E", "Mono12", 12, exposure_s=self.exposure_s)
        return CameraImage(pixels, PixelFormat.MONO16, now_s(), self.exposures, stated)


class Notes:
    """A record that keeps its documents."""

    def __init__(self) -> None:
        self.documents: dict[str, Any] = {}

    async def document(self, key: str, content: dict[str, Any]) -> None:
        self.documents.setdefault(key, {}).update(content)


def exposures(notes: Notes, **wanted: Any) -> RunExposures:
    """Exposures of a cell with one head and one camera."""
    asked = AutoExposureConfig(**(HOLES | wanted))
    section = SimpleNamespace(auto_exposure=asked)
    config = SimpleNamespace(cameras={"eye": section}, stereo_cameras={"head_1": section})
    cell = cast(Cell, SimpleNamespace(config=config, workers=InlineWorkers()))
    return RunExposures(cell, cast(RunRecorder, notes))


async def test_the_brighter_view_of_a_head_gets_the_grey_once() -> None:
    head, notes = Head(), Notes()
    run = exposures(notes)
    await run.find(head)
    assert head.exposure_s == pytest.approx(180 / 80e3, rel=0.05)
    taken = head.exposures
    (found,) = notes.documents["images.auto_exposure"].values()
    assert found["exposure_s"] == head.exposure_s
    assert found["grey"] == pytest.approx(180, abs=8)
    assert found["saturated_share"] == 0.0
    assert found["holes"] == 3
    assert found["exposures"] == taken <= 17
    # The light changes; the exposure of this run stays, and that of the next follows it.
    head.grey_a_ms /= 2
    await run.find(head)
    assert head.exposures == taken
    await exposures(notes).find(head)
    assert head.exposure_s == pytest.approx(180 / 40e3, rel=0.05)


async def test_a_deep_camera_is_judged_by_its_upper_eight_bits() -> None:
    camera, notes = DeepCamera(), Notes()
    await exposures(notes, target_grey=120.0).find(camera)
    assert camera.exposure_s == pytest.approx(120 / 50e3, rel=0.08)
    assert set(notes.documents["images.auto_exposure"]) == {"eye"}


@pytest.mark.parametrize(
    ("head", "wanted", "said"),
    [
        (Head(), {"exposure_ms": (0.1, 1.0)}, "head_1: its grey is .* limit of the exposure, 1 ms"),
        (FlickeringHead(), {"tries": 3}, "head_1: not in 3 exposures"),
        (HangingHead(), {"within_s": 0.05}, "head_1: not within 0.05 s"),
        (Head(), {"hole_px": (30.0, 50.0)}, "head_1: no holes of this size are seen"),
    ],
)
async def test_what_is_not_reached_is_a_fault(head: Head, wanted: Any, said: str) -> None:
    notes = Notes()
    with pytest.raises(ExposureNotReached, match=said):
        await exposures(notes, **wanted).find(head)
    assert notes.documents == {}


async def test_a_camera_without_the_setting_is_left_alone() -> None:
    head = Head()
    head.name = "head_2"
    section = SimpleNamespace(auto_exposure=None)
    config = SimpleNamespace(cameras={}, stereo_cameras={"head_2": section})
    cell = cast(Cell, SimpleNamespace(config=config, workers=InlineWorkers()))
    await RunExposures(cell, cast(RunRecorder, Notes())).find(head)
    assert head.exposures == 0


async def test_a_driver_that_cannot_set_one_says_so() -> None:
    section = SimpleNamespace(auto_exposure=AutoExposureConfig(**HOLES))  # type: ignore[arg-type]
    config = SimpleNamespace(cameras={"eye": section}, stereo_cameras={})
    cell = cast(Cell, SimpleNamespace(config=config, workers=InlineWorkers()))
    async with InProcessCamera("eye", PixelFormat.MONO8) as eye:
        with pytest.raises(ExposureNotAdjustable, match="eye"):
            await RunExposures(cell, cast(RunRecorder, Notes())).find(eye)


@pytest.mark.parametrize(
    "wrong", [{"hole_px": (12, 4)}, {"hole_px": (0, 4)}, {"exposure_ms": (5, 5)}, {"tries": 0}]
)
def test_limits_that_exclude_everything_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        AutoExposureConfig(**(HOLES | wrong))


@pytest.mark.parametrize(("driver", "issues"), [("frame-server", 1), ("gige", 0), ("nobody", 0)])
def test_check_refuses_it_for_a_driver_that_cannot_set_one(driver: str, issues: int) -> None:
    section = {"driver": driver, "simulated": True, "auto_exposure": HOLES}
    cell = CellConfig.model_validate({"name": "cell", "stereo_cameras": {"head_1": section}})
    found = [one for one in cross_issues(cell, []) if "auto_exposure" in one.key]
    assert len(found) == issues
    assert all("frame-server cannot set exposures" in one.allowed for one in found)
