"""Whether both cameras of a head see a hole well, apart from what stands between."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.planning.scene.head_limits import HeadLimits
from cellctl.planning.views.looks import middle_T_left
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.camera.stereo_projection import camera_points, pixels, right_camera_m
from cellctl.vision.features.hole import Hole

OUT_OF_FOCUS = "a hole is out of focus"
OUT_OF_PICTURE = "a hole is not in both images"
TOO_OBLIQUE = "a hole is seen too obliquely"
HIDDEN_BY_BORE = "a rim is hidden by its own bore"
UNLIT = "a hole is outside of the light"
_CHAMFER_SLOPE = 1.0
"""Tangent of the half angle at which a rim below the face is open to the sides, where the drawing
states no countersink: 45°, as chamfers are cut."""


@dataclass(frozen=True, eq=False)
class SeenHoles:
    """The holes of one part that one head is to see."""

    cell_T_part: RigidTransform
    holes: tuple[Hole, ...]

    @cached_property
    def places_m(self) -> Array:
        """Centres of the rims in the cell, shape (n, 3)."""
        return np.asarray(self.cell_T_part.apply([hole.position_m for hole in self.holes]))

    @cached_property
    def outward(self) -> Array:
        """Out of the face that is seen, in the cell, shape (3,)."""
        return np.asarray(self.cell_T_part.rotation.apply(outward_of(self.holes[0])))


def outward_of(hole: Hole) -> Array:
    """Out of the face, in the part, shape (3,); z where the drawing does not say."""
    return np.array([0.0, 0.0, 1.0]) if hole.outward is None else hole.outward


def sunk_m(hole: Hole) -> float:
    """How deep the rim lies below the face, which is at z = 0 of the part; 0 or more."""
    return max(0.0, -float(hole.position_m @ outward_of(hole)))


def why_unseen(
    head: StereoHead, limits: HeadLimits, cell_T_left: RigidTransform, seen: SeenHoles
) -> str | None:
    """The first condition that is not met; None for holes that are all seen well."""
    cell_T_camera = cell_T_left.as_matrix()
    points_m = (seen.places_m - cell_T_camera[:3, 3]) @ cell_T_camera[:3, :3]
    outward = seen.outward @ cell_T_camera[:3, :3]
    cameras = camera_points(head, points_m)
    depths_m = np.concatenate([one[:, 2] for one in cameras])
    if (depths_m < limits.nearest_m).any() or (depths_m > limits.farthest_m).any():
        return OUT_OF_FOCUS
    sizes_px = 1.0 + limits.margin_px
    size = np.array(head.image_size)
    for seen_px, in_camera in zip(pixels(head, points_m), cameras, strict=True):
        radius_px = _radii_px(head, in_camera, seen.holes) + sizes_px
        if (seen_px < radius_px[:, None]).any() or (seen_px > size - radius_px[:, None]).any():
            return OUT_OF_PICTURE
    right_m = right_camera_m(head)
    for centre_m in (np.zeros(3), right_m):
        slopes = _slopes(points_m - centre_m, outward)
        if (slopes > np.tan(limits.greatest_angle_rad)).any():
            return TOO_OBLIQUE
        if (slopes > [_open_slope(hole) for hole in seen.holes]).any():
            return HIDDEN_BY_BORE
    from_lamp = middle_T_left(head).apply(points_m)
    angles = np.arctan2(np.hypot(from_lamp[:, 0], from_lamp[:, 1]), from_lamp[:, 2])
    return UNLIT if (angles > limits.lit_within_rad).any() else None


def _slopes(rays_m: Array, outward: Array) -> Array:
    """Tangents of the angles between rays (n, 3) to the holes and the axis of the bores; infinite
    for a face that is turned away."""
    along = -rays_m @ outward
    across = np.linalg.norm(rays_m + along[:, None] * outward, axis=1)
    return np.where(along > 0.0, across / np.where(along > 0.0, along, 1.0), np.inf)


def _open_slope(hole: Hole) -> float:
    """Tangent up to which the whole rim is seen, over the edge of what it lies under."""
    depth_m = sunk_m(hole)
    # A rim in the face is hidden by nothing.
    if depth_m == 0.0:
        return np.inf
    if hole.countersink_m is None:
        return _CHAMFER_SLOPE
    return (hole.countersink_m - hole.diameter_m) / 2 / depth_m


def _radii_px(head: StereoHead, in_camera_m: Array, holes: tuple[Hole, ...]) -> Array:
    radii_m = np.array([(hole.countersink_m or hole.diameter_m) / 2 for hole in holes])
    focal_px = float(head.left.camera_matrix[0, 0])
    return np.asarray(focal_px * radii_m / in_camera_m[:, 2])
