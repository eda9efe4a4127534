"""Projection of one camera: exact against OpenCV and its own inverse."""

import cv2
import numpy as np
import pytest

from cellctl.vision.camera.lens import distort, distort_jacobians, project, undistort
from tests.rigs.calibration import wide_lens
from tests.unit.vision.plates import table_1_head

HEAD = table_1_head()


def test_projection_agrees_with_opencv_and_its_inverse() -> None:
    points = np.random.default_rng(1).uniform([-0.12, -0.1, 0.4], [0.12, 0.1, 0.6], (200, 3))
    ours = project(HEAD.left, points)
    theirs, _ = cv2.projectPoints(
        points, np.zeros(3), np.zeros(3), HEAD.left.camera_matrix, HEAD.left.distortion
    )
    assert np.abs(ours - theirs.reshape(-1, 2)).max() < 1e-9
    assert np.abs(undistort(HEAD.left, ours) - points[:, :2] / points[:, 2:]).max() < 1e-11


def test_jacobian_of_the_distortion() -> None:
    ray = np.array([0.12, -0.2])
    step = np.array([3e-5, -2e-5])
    change = distort(HEAD.right, (ray + step)[None])[0] - distort(HEAD.right, ray[None])[0]
    assert np.allclose(distort_jacobians(HEAD.right, ray[None])[0] @ step, change, atol=1e-5)


@pytest.mark.parametrize(
    "distortion", [wide_lens.RATIONAL, wide_lens.TILTED[:12], wide_lens.TILTED]
)
def test_lenses_of_more_terms(distortion: tuple[float, ...]) -> None:
    camera = wide_lens.camera(distortion)
    rays = np.random.default_rng(0).uniform(-0.7, 0.7, (50, 2))
    pixels = distort(camera, rays)
    np.testing.assert_allclose(undistort(camera, pixels), rays, atol=1e-9)
    # None of the terms is left out: without the last ones the pixels are others.
    fewer = wide_lens.camera(distortion[: {8: 5, 12: 8, 14: 12}[len(distortion)]])
    assert np.abs(distort(fewer, rays) - pixels).max() > 0.3
