"""Two rays to a point: epipolar distance, triangulation and its covariance."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skew
from cellctl.vision.camera.lens import undistort
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import pixels, pixels_by_point, right_camera_m

_STEPS = 2
"""Gauss-Newton steps. Started half-way between the rays, the first one leaves less than 1e-6 px."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoPoint:
    """A point seen by both cameras."""

    position_m: Array
    """Shape (3,), in the left camera."""
    covariance_m2: Array
    """Shape (3, 3)."""
    misfit_sigmas: float
    """Distance of the two image points from one ray pair, in standard deviations."""


def essential_matrix(rotation: Array, translation: Array) -> Array:
    """E = [t]× R, with ``x_rightᵀ E x_left = 0`` for normalised rays (paper, table 1)."""
    return skew(translation) @ rotation


def epipolar_distances_px(head: StereoHead, left_px: Array, right_px: Array) -> Array:
    """Distance of each right point from the epipolar line of each left point, shape (n, m)."""
    left = np.column_stack([undistort(head.left, left_px), np.ones(len(left_px))])
    right = np.column_stack([undistort(head.right, right_px), np.ones(len(right_px))])
    lines = left @ essential_matrix(head.rotation, head.translation_m).T
    lines /= np.linalg.norm(lines[:, :2], axis=1)[:, None]
    # The horizontal focal length stands for both: these distances are compared with thresholds,
    # which need no more than that.
    return np.asarray(np.abs(lines @ right.T) * head.right.camera_matrix[0, 0])


def midpoints(head: StereoHead, left_px: Array, right_px: Array) -> Array:
    """Points half-way between the two rays of each pair, shape (n, 3), left camera, m."""
    left = np.column_stack([undistort(head.left, left_px), np.ones(len(left_px))])
    right = np.column_stack([undistort(head.right, right_px), np.ones(len(right_px))])
    origin = right_camera_m(head)
    right = right @ head.rotation
    ll, rr, lr = (left**2).sum(1), (right**2).sum(1), (left * right).sum(1)
    lo, ro = left @ origin, right @ origin
    determinant = ll * rr - lr**2
    along_left = (rr * lo - lr * ro) / determinant
    along_right = (lr * lo - ll * ro) / determinant
    return np.asarray((left * along_left[:, None] + origin + right * along_right[:, None]) / 2.0)


def triangulate(
    head: StereoHead, left_px: Array, right_px: Array, covariance_px2: Array
) -> StereoPoint:
    """Maximum-likelihood point for two image points with their joint covariance, shape (4, 4)."""
    point = midpoints(head, left_px[None], right_px[None])[0]
    # The joint covariance, not two separate ones: where both images of a rim were fitted together,
    # their errors hang together, and what they share changes the depth less than its size suggests.
    weight = np.linalg.inv(covariance_px2)
    seen_px = np.concatenate([left_px, right_px])
    for _ in range(_STEPS):
        residual = seen_px - np.hstack(pixels(head, point[None]))[0]
        jacobian = pixels_by_point(head, point[None])[0]
        normal = jacobian.T @ weight @ jacobian
        step = np.linalg.solve(normal, jacobian.T @ weight @ residual)
        point = point + step
    # The residual after the last step, to first order: exact enough here, and it saves a
    # projection.
    residual = residual - jacobian @ step
    # Four coordinates and three unknowns leave one degree of freedom, that across the epipolar
    # line: the root of its square is a number of standard deviations.
    misfit = float(np.sqrt(max(float(residual @ weight @ residual), 0.0)))
    return StereoPoint(point, np.asarray(np.linalg.inv(normal), dtype=float), misfit)


def joint_covariance(left_px2: Array, right_px2: Array) -> Array:
    """Covariance of two independent image points, shape (4, 4)."""
    joint = np.zeros((4, 4))
    joint[:2, :2], joint[2:, 2:] = left_px2, right_px2
    return joint
