"""Where to look for a rim, and finding it there by its edges."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera import project
from cellctl.vision.features import Hole
from cellctl.vision.plane_patch import PlanePatch, plane_basis, plane_patch
from cellctl.vision.rim.edges import edge_circle
from cellctl.vision.stereo_head import CameraModel

RADIUS_TOLERANCE = 0.07
"""Largest relative difference of a rim from its nominal size."""
BAND_OUTSIDE_PX = 5.5
"""How far outside the rim its pixels are used."""

SIDES = ("left", "right")
"""The cameras of a head."""

_MIN_SUPPORT = 0.55


@dataclass(frozen=True, slots=True)
class Sight:
    """Where to look for a rim in one image."""

    image: Image
    camera: CameraModel
    centre_m: Array
    """Shape (3,), in the frame of the camera."""
    normal: Array
    """Unit normal of the rim's plane, away from the camera."""
    across: Array
    """A direction common to all cameras of the head; azimuths count from it."""

    @property
    def distance_m(self) -> float:
        """From the camera to the rim's plane."""
        return float(self.normal @ self.centre_m)


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why there is no rim."""

    reason: str
    side: str = ""
    """Camera, where it is known."""


@dataclass(frozen=True, slots=True)
class Located:
    """A rim located by its edges, to a fraction of a pixel."""

    point_px: Array
    """Raw pixel of its centre, shape (2,)."""
    size_ratio: float
    """Measured over nominal diameter, if the plane's distance is right."""
    support: float
    """Share of the circumference that shows an edge."""


def locate_rim(sight: Sight, hole: Hole, reach_px: float) -> Located | Rejection:
    """Find the rim within ``reach_px`` of where it should be, by its edges alone."""
    patch = patch_of(sight, hole, reach_px)
    if patch is None:
        return Rejection("lies outside the image")
    nominal = hole.diameter_m / 2.0 / sight.distance_m
    circle = edge_circle(
        sight.image,
        patch,
        patch.basis @ sight.centre_m / sight.distance_m,
        nominal,
        reach_px=reach_px,
        radius_tolerance=RADIUS_TOLERANCE,
        bright=hole.kind == "disc",
    )
    if circle is None:
        return Rejection("no round edge of the nominal size")
    if circle.support < _MIN_SUPPORT:
        return Rejection(f"only {circle.support:.0%} of the rim has an edge")
    return Located(patch.to_px(circle.centre[None])[0], circle.radius / nominal, circle.support)


def patch_of(sight: Sight, hole: Hole, reach_px: float) -> PlanePatch | None:
    """The plane round a hole's expected place, or None when it is cut off by the image's border."""
    middle = project(sight.camera, sight.centre_m[None])[0]
    focal = float(sight.camera.camera_matrix[0, 0])
    radius_px = focal * hole.diameter_m / 2.0 / float(sight.centre_m[2])
    half = radius_px * (1.0 + RADIUS_TOLERANCE) + reach_px + BAND_OUTSIDE_PX + 2.0
    size = np.array(sight.image.shape[::-1])
    if (middle < half).any() or (middle > size - 1 - half).any():
        return None
    basis = plane_basis(sight.normal, sight.across)
    return plane_patch(sight.camera, sight.normal, basis, middle, half)
