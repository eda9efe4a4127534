"""The projection of adjustments: that of the measurements, with the right derivatives."""

import numpy as np
import pytest

from cellctl.calibration.boards import projection
from cellctl.calibration.boards.projection import camera_vector
from cellctl.vision.camera.lens import project
from tests.rigs.calibration import wide_lens


@pytest.mark.parametrize(
    "distortion", [wide_lens.FIVE, wide_lens.RATIONAL, wide_lens.TILTED], ids=len
)
def test_derivatives_by_camera_and_point(distortion: tuple[float, ...]) -> None:
    vector = camera_vector(wide_lens.camera(distortion))
    points = np.random.default_rng(0).uniform((-0.2, -0.2, 0.4), (0.2, 0.2, 0.5), (20, 3))
    here = projection.project(vector, points)
    np.testing.assert_allclose(here.pixels, project(wide_lens.camera(distortion), points))
    for index, step in enumerate(np.where(vector > 100, 1e-3, 1e-6)):
        moved = vector + step * (np.arange(len(vector)) == index)
        difference = (projection.project(moved, points).pixels - here.pixels) / step
        np.testing.assert_allclose(here.by_camera[:, :, index], difference, rtol=1e-3, atol=0.02)
    for axis in range(3):
        nudged = points + 1e-7 * (np.arange(3) == axis)
        difference = (projection.project(vector, nudged).pixels - here.pixels) / 1e-7
        np.testing.assert_allclose(here.by_point[:, :, axis], difference, rtol=1e-3, atol=0.05)
