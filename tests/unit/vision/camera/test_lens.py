"""Projection of one camera: exact against OpenCV and its own inverse."""

import cv2
import numpy as np

from cellctl.vision.camera.lens import distort, distort_jacobian, project, undistort
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
    assert np.allclose(distort_jacobian(HEAD.right, ray) @ step, change, atol=1e-5)
