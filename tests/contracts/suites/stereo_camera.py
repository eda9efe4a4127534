"""What every stereo head must do."""

import numpy as np

from cellctl.interfaces.stereo_camera import StereoCamera
from tests.contracts.suites.exposure import ExposureBench, ExposureContract


class StereoCameraBench(ExposureBench):
    """A head under test, not connected."""

    camera: StereoCamera


class StereoCameraContract(ExposureContract):
    """What is asked of a head beyond what is asked of everything that exposes."""

    async def test_images(self, bench: StereoCameraBench) -> None:
        async with bench.camera as camera:
            pair = await camera.grab()
        assert pair.left.dtype == pair.right.dtype == np.uint8
        assert pair.left.ndim == 2
        assert pair.left.shape == pair.right.shape
        assert not np.array_equal(pair.left, pair.right)
