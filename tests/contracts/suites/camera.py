"""What every single camera must do, grey or colour."""

from abc import abstractmethod

import numpy as np

from cellctl.interfaces.camera import Camera, CameraImage, PixelFormat
from tests.contracts.suites.exposure import ExposureBench, ExposureContract

SHAPES = {
    PixelFormat.MONO8: (np.uint8, 2),
    PixelFormat.MONO16: (np.uint16, 2),
    PixelFormat.RGB8: (np.uint8, 3),
    PixelFormat.RGB16: (np.uint16, 3),
}
"""Type of a sample and number of dimensions."""


class SingleCameraBench(ExposureBench):
    """A camera under test, not connected."""

    camera: Camera

    @abstractmethod
    def truth(self) -> CameraImage:
        """What the newest exposure showed; its time is not looked at."""


class CameraContract(ExposureContract):
    """What is asked of a camera beyond what is asked of everything that exposes."""

    async def test_pixels_are_those_that_were_exposed(self, bench: SingleCameraBench) -> None:
        async with bench.camera as camera:
            images = [await camera.grab() for _ in range(2)]
        sample, dimensions = SHAPES[images[0].pixel_format]
        for image in images:
            assert image.pixels.dtype == sample
            assert image.pixels.ndim == dimensions
            assert image.pixels.shape[2:] in {(), (3,)}
        truth = bench.truth()
        assert images[-1].pixel_format is truth.pixel_format
        assert np.array_equal(images[-1].pixels, truth.pixels)
        assert not np.array_equal(images[0].pixels, images[1].pixels)
