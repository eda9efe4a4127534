"""How uncertain the centre of a hole will be in both images of a head, before any is taken."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.planning.scene.head_limits import ImageQuality
from cellctl.vision.camera.lens import distort_jacobian, project
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.average import remaining_variance

_ROUNDING_GREY2 = 1.0 / 12.0
_PIXEL_BOX_PX2 = 1.0 / 12.0
_RIM_POINTS = 48


@dataclass(frozen=True, slots=True)
class KindErrors:
    """What one kind of hole adds to the bound of an even disc."""

    over_bound: float
    """Standard deviation of a centre in one image over the Cramér–Rao bound of an even dark disc:
    light that has to be estimated along, texture, scratches."""
    common_px: float
    """What moves the rim alike in both images: an edge of unknown light, such as a chamfer."""


KINDS: Mapping[str, KindErrors] = {
    "pin": KindErrors(1.0, 0.003),
    "countersink": KindErrors(1.2, 0.002),
    "thread": KindErrors(1.3, 0.016),
    "disc": KindErrors(1.2, 0.0),
}
"""Fitted to holes of the fake cell at its taught poses (docs/planning.md, "What is predicted")."""


def camera_points(head: StereoHead, points_m: Array) -> tuple[Array, Array]:
    """Points of shape (n, 3) of the left camera in the frames of both cameras."""
    return points_m, points_m @ head.rotation.T + head.translation_m


def pixels(head: StereoHead, points_m: Array) -> tuple[Array, Array]:
    """Raw pixels in both images, shape (n, 2) each, of points in the left camera."""
    left_m, right_m = camera_points(head, points_m)
    return project(head.left, left_m), project(head.right, right_m)


def image_covariance(
    head: StereoHead, camera_T_part: RigidTransform, hole: Hole, quality: ImageQuality, frames: int
) -> Array:
    """Of the left and the right centre, in this order, in px², shape (4, 4).

    ``camera_T_part`` is for the left camera. The bound of each image is that of an even disc (docs/
    metrology.md): F = A² / (2 √π σe σn²) ∮ n nᵀ ds along the ellipse that the rim is in the image.
    """
    errors = KINDS[hole.kind]
    maps = _plane_to_images(head, camera_T_part, hole)
    joint = np.zeros((4, 4))
    for image, in_image in enumerate(maps):
        place = slice(2 * image, 2 * image + 2)
        joint[place, place] = errors.over_bound**2 * _bound_px2(
            in_image, hole.diameter_m / 2, quality
        )
    both = np.vstack(maps)
    # One shift in the plane of the rim, whose length in pixels is that of the mean of both images.
    scale = np.mean([np.sqrt(abs(np.linalg.det(one))) for one in maps])
    joint += (errors.common_px / scale) ** 2 * both @ both.T
    return np.asarray(joint * remaining_variance(frames))


def _plane_to_images(
    head: StereoHead, camera_T_part: RigidTransform, hole: Hole
) -> tuple[Array, Array]:
    """Pixels by metres along x and y of the part at a hole, shape (2, 2), left and right."""
    centre_m = camera_T_part.apply(hole.position_m)
    axes = camera_T_part.rotation.as_matrix()[:, :2]
    left_m, right_m = camera_points(head, centre_m[None])
    left = _by_point(head.left, left_m[0]) @ axes
    right = _by_point(head.right, right_m[0]) @ head.rotation @ axes
    return left, right


def _by_point(camera: CameraModel, point_m: Array) -> Array:
    """Derivative of the raw pixel by the point in the camera, shape (2, 3)."""
    x, y, z = point_m
    ray = np.array([[1.0 / z, 0.0, -x / z**2], [0.0, 1.0 / z, -y / z**2]])
    return np.asarray(distort_jacobian(camera, point_m[:2] / z) @ ray)


def _bound_px2(in_image: Array, radius_m: float, quality: ImageQuality) -> Array:
    angles = 2.0 * np.pi * np.arange(_RIM_POINTS) / _RIM_POINTS
    tangents = in_image @ (radius_m * np.array([-np.sin(angles), np.cos(angles)]))
    lengths = np.linalg.norm(tangents, axis=0)
    normals = np.array([tangents[1], -tangents[0]]) / lengths
    ring = (normals * lengths) @ normals.T * (2.0 * np.pi / _RIM_POINTS)
    edge_px = np.sqrt(quality.blur_px**2 + _PIXEL_BOX_PX2)
    noise_grey2 = quality.noise_grey**2 + _ROUNDING_GREY2
    known = quality.contrast_grey**2 / (2.0 * np.sqrt(np.pi) * edge_px * noise_grey2) * ring
    return np.asarray(np.linalg.inv(known))
