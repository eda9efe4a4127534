"""Which grey values of a camera's image are measured."""

import numpy as np
import pytest

from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.processes.antenna_module.faults.connector import PixelsNotMeasurable
from cellctl.processes.antenna_module.looking import measured_channel
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
