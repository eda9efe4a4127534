"""Region of interest of a rim in one image, and finding the rim in it by its edges."""

from dataclasses import dataclass

import numpy as np

from cellctl.errors.vision import HoleMissing
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.lens import project
from cellctl.vision.camera.plane_patch import PlanePatch, plane_basis, plane_patch
from cellctl.vision.camera.stereo_head import CameraModel
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.hole_kind import HoleKind
from cellctl.vision.features.known_kinds import kind_of
from cellctl.vision.measurement import Side
from cellctl.vision.rim.edges import edge_circle

RADIUS_TOLERANCE = 0.07
"""Largest relative difference of a rim from its nominal size."""
BAND_OUTSIDE_PX = 5.5
"""Width of the band of pixels used outside the rim: wide enough to see the level of the face behind
the blur of the edge, narrow enough to stay clear of most neighbours."""

_MIN_SUPPORT = 0.55
"""Share of the circumference that must show an edge. A scratch or a reflex may hide nearly half of
a rim; below this an arc of something else would pass for one."""
_BORDER_PX = 2.0
"""Distance kept from the border of the image: the samples of a patch are interpolated and
blurred."""


@dataclass(frozen=True, slots=True, eq=False)
class RimRoi:
    """The region of interest of one rim in one image."""

    hole: Hole
    side: Side
    image: Image
    camera: CameraModel
    centre_m: Array
    """Expected centre, shape (3,), in the frame of this camera."""
    normal: Array
    """Unit normal of the rim's plane, pointing away from the camera, shape (3,)."""
    across: Array
    """A direction common to both cameras of the head, shape (3,): azimuths count from it, so that
    azimuths in both images mean the same."""

    @property
    def kind(self) -> HoleKind:
        """The kind of the hole."""
        return kind_of(self.hole)

    @property
    def distance_m(self) -> float:
        """Distance from the camera to the rim's plane, along its normal."""
        return float(self.normal @ self.centre_m)

    @property
    def nominal_radius(self) -> float:
        """Radius of the rim in the plane units of ``PlanePatch``."""
        return self.hole.diameter_m / 2.0 / self.distance_m

    def refusal(self, reason: str) -> HoleMissing:
        """The fault to raise when the rim cannot be measured in this image."""
        return HoleMissing(f"{self.hole.name} ({self.side}): {reason}")

    def patch(self, reach_px: float) -> PlanePatch | None:
        """The rim's plane round the expected place and ``reach_px`` beyond the largest rim.

        None when the border of the image cuts it off.
        """
        middle = project(self.camera, self.centre_m[None])[0]
        focal_px = float(self.camera.camera_matrix[0, 0])
        radius_px = focal_px * self.hole.diameter_m / 2.0 / float(self.centre_m[2])
        half = radius_px * (1.0 + RADIUS_TOLERANCE) + reach_px + BAND_OUTSIDE_PX + _BORDER_PX
        size = np.array(self.image.shape[::-1])
        if (middle < half).any() or (middle > size - 1 - half).any():
            return None
        basis = plane_basis(self.normal, self.across)
        return plane_patch(self.camera, self.normal, basis, middle, half)

    def patch_or_refuse(self, reach_px: float) -> PlanePatch:
        """``patch``, but raises ``HoleMissing`` when the border cuts it off."""
        patch = self.patch(reach_px)
        if patch is None:
            raise self.refusal("lies outside the image")
        return patch


@dataclass(frozen=True, slots=True, eq=False)
class LocatedRim:
    """A rim located by its edges, to a fraction of a pixel."""

    point_px: Array
    """Raw pixel of its centre, shape (2,)."""
    size_ratio: float
    """Measured over nominal diameter, if the plane's distance is right."""
    support: float
    """Share of the circumference that shows an edge."""


def locate_rim(roi: RimRoi, reach_px: float) -> LocatedRim:
    """Find the rim within ``reach_px`` of where it is expected, by its edges alone.

    Raises ``HoleMissing`` when there is no round edge of the nominal size.
    """
    patch = roi.patch_or_refuse(reach_px)
    circle = edge_circle(
        roi.image,
        patch,
        patch.basis @ roi.centre_m / roi.distance_m,
        roi.nominal_radius,
        reach_px=reach_px,
        radius_tolerance=RADIUS_TOLERANCE,
        bright=roi.kind.bright,
    )
    if circle is None:
        raise roi.refusal("no round edge of the nominal size")
    if circle.support < _MIN_SUPPORT:
        raise roi.refusal(f"only {circle.support:.0%} of the rim has an edge")
    size_ratio = circle.radius / roi.nominal_radius
    return LocatedRim(patch.to_px(circle.centre[None])[0], size_ratio, circle.support)
