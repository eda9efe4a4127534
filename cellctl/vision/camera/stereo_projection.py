"""Points in both images of a stereo head, and how their pixels move with them."""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera.lens import distort_jacobians, project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead


def camera_points(head: StereoHead, points_m: Array) -> tuple[Array, Array]:
    """Points of shape (n, 3) of the left camera in the frames of both cameras."""
    return points_m, points_m @ head.rotation.T + head.translation_m


def right_camera_m(head: StereoHead) -> Array:
    """Where the right camera is in the left one, shape (3,)."""
    return np.asarray(-head.rotation.T @ head.translation_m)


def pixels(head: StereoHead, points_m: Array) -> tuple[Array, Array]:
    """Raw pixels in both images, shape (n, 2) each, of points in the left camera."""
    left_m, right_m = camera_points(head, points_m)
    return project(head.left, left_m), project(head.right, right_m)


def pixels_by_point(head: StereoHead, points_m: Array) -> Array:
    """Derivatives of both pixels, left and right, by points (n, 3) in the left camera, shape
    (n, 4, 3)."""
    left_m, right_m = camera_points(head, points_m)
    left = _by_point(head.left, left_m)
    right = _by_point(head.right, right_m) @ head.rotation
    return np.concatenate([left, right], axis=1)


def _by_point(camera: CameraModel, points_m: Array) -> Array:
    """Derivatives of the raw pixels by points (n, 3) in the camera, shape (n, 2, 3)."""
    rays = points_m[:, :2] / points_m[:, 2:]
    by_point = np.zeros((len(points_m), 2, 3))
    by_point[:, 0, 0] = by_point[:, 1, 1] = 1.0
    by_point[:, :, 2] = -rays
    by_point /= points_m[:, 2, None, None]
    return np.asarray(distort_jacobians(camera, rays) @ by_point)
