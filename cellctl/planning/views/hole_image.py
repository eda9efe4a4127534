"""How uncertain the centre of a hole will be in both images of a head, before any is taken."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.planning.scene.head_limits import ImageQuality
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import pixels_by_point
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


def image_covariances(
    head: StereoHead,
    camera_T_part: RigidTransform,
    holes: Sequence[Hole],
    quality: ImageQuality,
    frames: int,
) -> Array:
    """Of the left and the right centre of each hole, in this order, in px², shape (n, 4, 4).

    ``camera_T_part`` is for the left camera. The bound of each image is that of an even disc (docs/
    metrology.md): F = A² / (2 √π σe σn²) ∮ n nᵀ ds along the ellipse that the rim is in the image.
    """
    places_m = camera_T_part.apply([hole.position_m for hole in holes])
    # Pixels by metres along x and y of the part.
    maps = pixels_by_point(head, places_m) @ camera_T_part.rotation.as_matrix()[:, :2]
    left, right = maps[:, :2], maps[:, 2:]
    kinds = [KINDS[hole.kind] for hole in holes]
    over_bound = np.array([kind.over_bound for kind in kinds])[:, None, None]
    radii_m = np.array([hole.diameter_m / 2 for hole in holes])
    joint = np.zeros((len(holes), 4, 4))
    joint[:, :2, :2] = over_bound**2 * _bounds_px2(left, radii_m, quality)
    joint[:, 2:, 2:] = over_bound**2 * _bounds_px2(right, radii_m, quality)
    # One shift in the plane of the rim, whose length in pixels is that of the mean of both images.
    scales = np.sqrt(np.abs(np.linalg.det(np.stack([left, right])))).mean(axis=0)
    shifts = np.array([kind.common_px for kind in kinds]) / scales
    joint += (shifts**2)[:, None, None] * maps @ maps.swapaxes(1, 2)
    return np.asarray(joint * remaining_variance(frames))


def _bounds_px2(in_image: Array, radii_m: Array, quality: ImageQuality) -> Array:
    """``in_image``: pixels by metres in the plane of each rim, shape (n, 2, 2)."""
    angles = 2.0 * np.pi * np.arange(_RIM_POINTS) / _RIM_POINTS
    tangents = in_image @ (radii_m[:, None, None] * np.array([-np.sin(angles), np.cos(angles)]))
    lengths = np.linalg.norm(tangents, axis=1, keepdims=True)
    normals = np.stack([tangents[:, 1], -tangents[:, 0]], axis=1) / lengths
    rings = (normals * lengths) @ normals.swapaxes(1, 2) * (2.0 * np.pi / _RIM_POINTS)
    edge_px = np.sqrt(quality.blur_px**2 + _PIXEL_BOX_PX2)
    noise_grey2 = quality.noise_grey**2 + _ROUNDING_GREY2
    known = quality.contrast_grey**2 / (2.0 * np.sqrt(np.pi) * edge_px * noise_grey2) * rings
    return np.asarray(np.linalg.inv(known))
