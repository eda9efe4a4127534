"""Projection of one camera: rays to raw pixels and back."""

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.stereo_head import CameraModel

# The default stops after five iterations, which leaves pixels of error with a strong distortion.
_UNDISTORT_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-12)


def project(camera: CameraModel, points: Array) -> Array:
    """Raw pixels, shape (n, 2), of points, shape (n, 3), in the frame of the camera."""
    return distort(camera, points[:, :2] / points[:, 2:])


def distort(camera: CameraModel, rays: Array) -> Array:
    """Raw pixels, shape (n, 2), of undistorted rays x/z, y/z, shape (n, 2)."""
    # ``cv2.projectPoints`` gives the same, but its fixed cost is too high for the many calls with
    # few points that the fit of a rim makes. Lenses of more than five terms are rare.
    if len(camera.distortion) != 5:
        points = np.column_stack([rays, np.ones(len(rays))])
        pixels, _ = cv2.projectPoints(
            points, np.zeros(3), np.zeros(3), camera.camera_matrix, camera.distortion
        )
        return np.asarray(pixels, dtype=float).reshape(-1, 2)
    k1, k2, p1, p2, k3 = camera.distortion.tolist()
    x, y = rays[:, 0], rays[:, 1]
    xx, yy, twice_xy = x * x, y * y, 2.0 * x * y
    r2 = xx + yy
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    bent = np.empty_like(rays)
    bent[:, 0] = x * radial + p1 * twice_xy + p2 * (r2 + 2.0 * xx)
    bent[:, 1] = y * radial + p1 * (r2 + 2.0 * yy) + p2 * twice_xy
    return bent @ camera.camera_matrix[:2, :2].T + camera.camera_matrix[:2, 2]


def undistort(camera: CameraModel, pixels: Array) -> Array:
    """Undistorted rays x/z, y/z, shape (n, 2), of raw pixels, shape (n, 2)."""
    points = np.ascontiguousarray(pixels, dtype=float).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(
        points, camera.camera_matrix, camera.distortion, criteria=_UNDISTORT_CRITERIA
    )
    return np.asarray(rays, dtype=float).reshape(-1, 2)


def distort_jacobians(camera: CameraModel, rays: Array) -> Array:
    """Derivatives of ``distort`` at rays of shape (n, 2), shape (n, 2, 2), px."""
    # At a focal length of some thousand pixels this is a few thousandths of a pixel: small against
    # the curvature of any lens, large against the rounding of the projection.
    step = 1e-6
    offsets = np.array([[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]])
    around = (rays[:, None, :] + offsets).reshape(-1, 2)
    pixels = distort(camera, around).reshape(-1, 4, 2)
    differences = np.stack([pixels[:, 0] - pixels[:, 1], pixels[:, 2] - pixels[:, 3]], axis=-1)
    return np.asarray(differences / (2.0 * step))
