"""Camera, plane patch, ellipse, triangulation: exact against independent formulas."""

import cv2
import numpy as np
import pytest

from cellctl.vision.camera.ellipse import conic_of_circle, eccentricity, ellipse_of_circle
from cellctl.vision.camera.lens import distort, distort_jacobian, project, undistort
from cellctl.vision.camera.plane_patch import plane_basis, plane_patch, to_plane
from cellctl.vision.camera.triangulation import (
    epipolar_distances_px,
    essential_matrix,
    fundamental_matrix,
    joint_covariance,
    triangulate,
)
from tests.unit.vision.plates import plate_facing, table_1_head

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


def test_plane_patch_is_exact_over_a_hole_and_a_circle_is_a_circle_there() -> None:
    camera_T_part = plate_facing(30.0, -40.0, 8.0)
    normal = -camera_T_part.rotation.apply([0.0, 0.0, 1.0])
    centre = camera_T_part.apply([0.02, 0.03, 0.0])
    angles = np.linspace(0, 2 * np.pi, 50)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(50)]) * 3e-3
    pixels = project(HEAD.left, camera_T_part.apply(ring + np.array([0.02, 0.03, 0.0])))
    middle = project(HEAD.left, centre[None])[0]
    patch = plane_patch(HEAD.left, normal, plane_basis(normal), middle, 40.0)
    points, jacobian = patch.from_px(pixels[:, 0], pixels[:, 1])
    exact = to_plane(HEAD.left, pixels, normal, patch.basis).T
    assert np.abs(points - exact).max() / patch.unit_px < 1e-5
    distance = float(normal @ centre)
    flat = patch.basis @ centre / distance
    radii = np.linalg.norm(points - flat[:, None], axis=0) * distance
    assert np.abs(radii - 3e-3).max() < 1e-9
    moved, _ = patch.from_px(pixels[:1, 0] + 0.01, pixels[:1, 1])
    assert np.allclose((moved - points[:, :1])[:, 0] / 0.01, jacobian[:, 0, 0], rtol=1e-3)
    assert np.abs(patch.to_px(points.T) - pixels).max() < 1e-5


@pytest.mark.parametrize(
    ("diameter_mm", "expected_px"), [(5.0, 0.0148), (6.0, 0.0213), (10.0, 0.0593), (20.0, 0.237)]
)
def test_eccentricity_of_a_frontal_plate(diameter_mm: float, expected_px: float) -> None:
    """Published figures for f 3580 px, 500 mm, 10° between axis and plate."""
    normal = np.array([np.sin(np.radians(10)), 0.0, np.cos(np.radians(10))])
    offset = eccentricity(np.array([0.0, 0.0, 0.5077]), normal, diameter_mm / 2000) * 3580
    assert np.hypot(*offset) == pytest.approx(expected_px, rel=0.05)


def test_the_conic_of_a_circle_holds_its_image() -> None:
    normal = np.array([0.2, -0.1, 0.97])
    normal /= np.linalg.norm(normal)
    centre = np.array([0.03, -0.05, 0.5])
    basis = plane_basis(normal)
    angles = np.linspace(0, 2 * np.pi, 20)
    ring = centre + 3e-3 * (np.column_stack([np.cos(angles), np.sin(angles)]) @ basis)
    rays = ring / ring[:, 2:]
    conic = conic_of_circle(centre, normal, 3e-3)
    assert np.abs(np.einsum("ni,ij,nj->n", rays, conic, rays)).max() < 1e-12
    middle, scale = rays[:, :2].mean(axis=0), 3e-3 / 0.5
    x, y = ((rays[:, :2] - middle) / scale).T
    design = np.column_stack([x * x, x * y, y * y, x, y])
    a, b, c, d, e = np.linalg.lstsq(design, np.ones(len(x)), rcond=None)[0]
    seen = middle - scale * np.linalg.solve([[2 * a, b], [b, 2 * c]], [d, e])
    predicted = centre[:2] / centre[2] + eccentricity(centre, normal, 3e-3)
    assert np.allclose(seen, predicted, atol=1e-9)


def test_the_ellipse_of_a_circle_lies_on_its_image() -> None:
    normal = np.array([0.3, -0.2, 0.93]) / np.linalg.norm([0.3, -0.2, 0.93])
    centre, radius_m = np.array([0.03, -0.05, 0.5]), 3e-3
    basis = plane_basis(normal)
    unit_px = 1e-6 * basis
    at, across, along = project(HEAD.left, centre + np.vstack([np.zeros(3), unit_px]))
    jacobian = np.column_stack([across - at, along - at]) / 1e-6 * radius_m
    drawn = ellipse_of_circle(at, jacobian).points(60)
    turns = np.linspace(0, 2 * np.pi, 2000)
    rim = centre + radius_m * (np.column_stack([np.cos(turns), np.sin(turns)]) @ basis)
    gaps = np.linalg.norm(project(HEAD.left, rim)[None] - drawn[:, None], axis=2).min(axis=1)
    assert gaps.max() < 0.15


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
    fundamental = fundamental_matrix(HEAD)
    misfit = np.einsum("ni,ij,nj->n", straight_right, fundamental, straight_left)
    assert np.abs(misfit).max() < 1e-9 * np.abs(fundamental).max() * 2448**2
