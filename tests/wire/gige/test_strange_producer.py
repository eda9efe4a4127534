"""A producer that is not ours, as it comes with the library of the standard: colour, no trigger."""

from pathlib import Path

import genicam
import numpy as np

from cellctl.interfaces.camera import PixelFormat
from drivers.camera.gige.config import GigeCameraConfig, Selection
from drivers.camera.gige.driver import GigeCamera

VIKY = Path(genicam.__file__).parent / "viky.cti"


async def test_a_camera_that_runs_freely() -> None:
    settings = GigeCameraConfig(
        camera=Selection(serial_number="1"), producers=(VIKY,), trigger="none"
    )
    async with GigeCamera("viky", settings) as camera:
        images = [await camera.grab() for _ in range(2)]
    assert [image.pixel_format for image in images] == [PixelFormat.RGB8] * 2
    assert images[0].pixels.shape == (400, 400, 3)
    assert images[0].pixels.dtype == np.uint8
    assert images[1].time_s > images[0].time_s
