"""Two rays to a point: exact, and as uncertain as it says."""

import numpy as np

from cellctl.vision.camera.lens import project, undistort
from cellctl.vision.camera.triangulation import (
    epipolar_distances_px,
    essential_matrix,
    joint_covariance,
    triangulate,
)
from tests.unit.vision.plates import table_1_head

HEAD = table_1_head()


def test_triangulation_is_exact_and_its_covariance_is_that_of_its_scatter() -> None:
    rng = np.random.default_rng(3)
    point = np.array([0.02, -0.03, 0.51])
    left = project(HEAD.left, point[None])[0]
    right = project(HEAD.right, HEAD.right_T_left.apply(point)[None])[0]
    joint = joint_covariance(np.diag([4e-4, 1e-4]), np.array([[2e-4, 1e-4], [1e-4, 3e-4]]))
    exact = triangulate(HEAD, left, right, joint)
    assert np.abs(exact.position_m - point).max() < 1e-12
    assert exact.misfit_sigmas < 1e-6
    noise = rng.multivariate_normal(np.zeros(4), joint, 400)
    results = [triangulate(HEAD, left + n[:2], right + n[2:], joint).position_m for n in noise]
    errors = np.array(results) - point
    squared = np.einsum("ni,ij,nj->n", errors, np.linalg.inv(exact.covariance_m2), errors)
    assert abs(squared.mean() - 3.0) < 4.0 * np.sqrt(6.0 / 400)


def test_essential_and_fundamental_matrix_vanish_on_true_pairs() -> None:
    points = np.random.default_rng(1).uniform([-0.1, -0.1, 0.45], [0.1, 0.1, 0.55], (30, 3))
    left = project(HEAD.left, points)
    right = project(HEAD.right, HEAD.right_T_left.apply(points))
    assert np.diag(epipolar_distances_px(HEAD, left, right)).max() < 1e-8
    essential = essential_matrix(HEAD.rotation, HEAD.translation_m)
    assert np.linalg.svd(essential, compute_uv=False)[2] < 1e-15
    pinhole_left = np.column_stack([undistort(HEAD.left, left), np.ones(30)])
    pinhole_right = np.column_stack([undistort(HEAD.right, right), np.ones(30)])
    straight_left = pinhole_left @ HEAD.left.camera_matrix.T
    straight_right = pinhole_right @ HEAD.right.camera_matrix.T
    inverses = (np.linalg.inv(camera.camera_matrix) for camera in (HEAD.left, HEAD.right))
    by_left, by_right = inverses
    fundamental = by_right.T @ essential @ by_left
    fundamental /= fundamental[2, 2]
    misfit = np.einsum("ni,ij,nj->n", straight_right, fundamental, straight_left)
    assert np.abs(misfit).max() < 1e-9 * np.abs(fundamental).max() * 2448**2
