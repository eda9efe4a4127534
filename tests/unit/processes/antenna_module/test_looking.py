"""Which grey values of a camera's image are measured, and what of it is recorded."""

from collections.abc import Callable
from typing import Any, cast
from unittest.mock import AsyncMock, Mock

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import ImageBlack
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.processes.antenna_module import looking
from cellctl.processes.antenna_module.faults.connector import PixelsNotMeasurable
from cellctl.processes.antenna_module.faults.plugging import LooksDisagree
from cellctl.processes.antenna_module.looking import Eyes, combined, measured_channel
from cellctl.processes.antenna_module.vision.pixels import mosaic_plane
from drivers.camera.gige.pixels import decoded

RAMP = np.arange(4096, dtype=np.uint16).reshape(64, 64)


@pytest.mark.parametrize(("name", "bits"), [("Mono10", 10), ("Mono12", 12), ("Mono16", 16)])
def test_deep_images_of_the_gige_driver_are_measured_in_their_upper_bits(
    name: str, bits: int
) -> None:
    deep = RAMP << 4 if bits == 16 else RAMP >> (12 - bits)
    raw = np.frombuffer(deep.astype("<u2").tobytes(), np.uint8)
    pixels, pixel_format = decoded(raw, name, 64, 64)
    exposure = ExposureRecord("1", name, bits)
    plane = measured_channel(CameraImage(pixels, pixel_format, 0.0, 1, exposure))
    assert plane.dtype == np.uint8
    np.testing.assert_array_equal(plane, RAMP >> 4)


def test_deep_images_of_unknown_depth_are_refused_by_number() -> None:
    """Taken for 16 bits, a camera of 12 would be almost black."""
    with pytest.raises(PixelsNotMeasurable, match="Mono16"):
        measured_channel(CameraImage(RAMP, PixelFormat.MONO16, 0.0, 1))


def test_green_of_deep_colour_is_measured_in_its_upper_eight_bits() -> None:
    colour = np.zeros((4, 4, 3), np.uint16)
    colour[:, :, 1] = 0xABC
    twelve = ExposureRecord("1", "BayerRG12", 12)
    image = CameraImage(colour, PixelFormat.RGB16, 0.0, 1, twelve)
    assert measured_channel(image).tolist() == [[0xAB] * 4] * 4
    with pytest.raises(PixelsNotMeasurable, match="RGB16"):
        measured_channel(CameraImage(colour, PixelFormat.RGB16, 0.0, 1))


def test_green_of_the_gige_driver_is_the_green_of_the_mosaic() -> None:
    """Its colours are filled in from their own neighbours alone, so that no edge moves."""
    mosaic = np.random.default_rng(3).integers(0, 256, (40, 60), dtype=np.uint8)
    pixels, pixel_format = decoded(mosaic.ravel(), "BayerRG8", 60, 40)
    plane = measured_channel(CameraImage(pixels, pixel_format, 0.0, 1))
    inside = (slice(1, -1), slice(1, -1))
    off = plane[inside].astype(int) - mosaic_plane(mosaic)[inside].astype(int)
    # Means of four that end in a half are rounded up by one, to the even number by the other.
    assert np.abs(off).max() <= 1
    assert np.abs(off).mean() < 0.1


async def test_each_raw_image_is_recorded_with_its_exposure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(looking, "settle", AsyncMock())
    monkeypatch.setattr(looking, "require_unmoved", Mock())
    exposures = [ExposureRecord("1", "Mono8", 8, exposure_s=seconds) for seconds in (0.01, 0.02)]
    grey = np.zeros((4, 4), np.uint8)
    images = [CameraImage(grey, PixelFormat.MONO8, n, n, one) for n, one in enumerate(exposures)]
    recorder = Mock(exposures=AsyncMock(), add=AsyncMock())
    camera = Mock(grab=AsyncMock(side_effect=images))
    camera.name = "over_tray"

    async def find(device: Any) -> None:
        assert device is camera
        camera.grab.assert_not_awaited()

    exposing = Mock(find=AsyncMock(side_effect=find))

    async def run(measure: Callable[[Any], Any], image: Any) -> Any:
        return measure(image)

    eyes = Eyes(Mock(), Mock(run=run), recorder, frames=2, exposures=exposing)
    seen = await eyes.look("tray", cast(Camera, camera), np.sum)
    # Of the last image: what comes after it, measuring for one, makes a look older and not newer.
    assert seen.time_s == 1.0
    exposing.find.assert_awaited_once()
    files = [f"raw/tray-frame-{number}.pgm.zst" for number in (1, 2)]
    assert [call.args[0] for call in recorder.raw_image.call_args_list] == files
    told = [call.args[0] for call in recorder.exposures.call_args_list]
    assert told == [{file: one} for file, one in zip(files, exposures, strict=True)]
    taken = [call.args[0].content for call in recorder.add.call_args_list]
    assert [(*one, one[file]["view"]) for one, file in zip(taken, files, strict=True)] == [
        (file, "over_tray") for file in files
    ]


def test_frames_of_a_scene_that_moved_meanwhile_are_not_combined() -> None:
    def seen(x_m: float) -> UncertainPose:
        return UncertainPose(RigidTransform.from_translation([x_m, 0.0, 0.25]), np.eye(6) * 1e-12)

    still = combined((seen(0.0), seen(2e-6), seen(4e-6)))
    assert still.pose.translation[0] == pytest.approx(2e-6)
    # The mean is as uncertain as one of them: they have drawing, light and plane in common.
    np.testing.assert_array_equal(still.covariance, seen(0.0).covariance)
    with pytest.raises(LooksDisagree, match=r"20\.0 µm off"):
        combined((seen(0.0), seen(0.0), seen(30e-6)))


async def test_an_image_that_cannot_be_measured_names_its_camera(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(looking, "settle", AsyncMock())
    image = CameraImage(np.zeros((4, 4), np.uint8), PixelFormat.MONO8, 0.0, 1)
    camera = Mock(grab=AsyncMock(return_value=image))
    camera.name = "over_tray"
    workers = Mock(run=AsyncMock(side_effect=ImageBlack("image: brightest grey value is 0")))
    with pytest.raises(ImageBlack) as raised:
        await Eyes(Mock(), workers, None, frames=1).look("tray", cast(Camera, camera), np.sum)
    assert raised.value.detail == "over_tray, image: brightest grey value is 0"
