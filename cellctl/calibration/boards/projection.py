"""The camera model with its derivatives, for adjustments.

A camera is a vector in the order of ``CAMERA_PARAMETERS``: nine numbers with five terms of
distortion, 12, 16 or 18 with more.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import CameraModel


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """Projected points and how they move."""

    pixels: Array
    """Shape (n, 2)."""
    by_point: Array
    """Derivative by the point in the camera frame, shape (n, 2, 3), px/m."""
    by_camera: Array
    """Derivative by the camera's numbers, shape (n, 2, 4 + terms)."""


def camera_vector(camera: CameraModel) -> Array:
    """The numbers of a camera."""
    matrix = camera.camera_matrix
    inner = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]]
    return np.concatenate([inner, camera.distortion])


def camera_model(vector: Array) -> CameraModel:
    """The camera of such numbers."""
    fx, fy, cx, cy = vector[:4]
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return CameraModel(matrix, np.array(vector[4:]))


# Beside the projection of ``vision.camera.lens``, because the adjustment needs the derivatives by
# the camera, and the measuring of holes neither needs nor can afford them.
def project(camera: Array, points_m: Array) -> Projection:
    """Project points of shape (n, 3), given in the camera frame."""
    if len(camera) != 9:
        return _project_by_opencv(camera, points_m)
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = camera
    depth = points_m[:, 2]
    x, y = points_m[:, 0] / depth, points_m[:, 1] / depth
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = k1 + r2 * (2 * k2 + 3 * r2 * k3)
    xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y

    # Derivatives of the distorted by the plain image point; the mixed one is the same for both.
    cross = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y
    xd_x = radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x
    yd_y = radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x
    # By the chain rule through x = X/Z, y = Y/Z.
    by_point = np.empty((len(points_m), 2, 3))
    by_point[:, 0, 0], by_point[:, 0, 1] = fx * xd_x / depth, fx * cross / depth
    by_point[:, 1, 0], by_point[:, 1, 1] = fy * cross / depth, fy * yd_y / depth
    by_point[:, 0, 2] = -fx * (xd_x * x + cross * y) / depth
    by_point[:, 1, 2] = -fy * (cross * x + yd_y * y) / depth

    by_camera = np.zeros((len(points_m), 2, 9))
    by_camera[:, 0, 0], by_camera[:, 1, 1] = xd, yd
    by_camera[:, 0, 2] = by_camera[:, 1, 3] = 1.0
    by_camera[:, 0, 4:] = fx * np.stack(
        [x * r2, x * r2**2, 2 * x * y, r2 + 2 * x * x, x * r2**3], axis=1
    )
    by_camera[:, 1, 4:] = fy * np.stack(
        [y * r2, y * r2**2, r2 + 2 * y * y, 2 * x * y, y * r2**3], axis=1
    )
    return Projection(np.stack([fx * xd + cx, fy * yd + cy], axis=1), by_point, by_camera)


def _project_by_opencv(camera: Array, points_m: Array) -> Projection:
    """``project`` for lenses of more than five terms; slower, because it also turns the points."""
    model = camera_model(camera)
    pixels, jacobian = cv2.projectPoints(
        points_m, np.zeros(3), np.zeros(3), model.camera_matrix, model.distortion
    )
    # Columns: turn and shift of the points, focal lengths, principal point, distortion. A shift of
    # the points is what moves each of them.
    columns = np.asarray(jacobian, dtype=float).reshape(len(points_m), 2, -1)
    return Projection(
        np.asarray(pixels, dtype=float).reshape(-1, 2), columns[:, :, 3:6], columns[:, :, 6:]
    )
