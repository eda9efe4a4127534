"""What is to be fitted: the pixels round a located rim, in the coordinates of its plane."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.features import Hole
from cellctl.vision.plane_patch import PlanePatch, to_plane
from cellctl.vision.rim.lay import lay_across
from cellctl.vision.rim.model import RimPixels
from cellctl.vision.rim.sight import BAND_OUTSIDE_PX, Located, Rejection, Sight, patch_of

_BAND_INSIDE_PX, _THREAD_INSIDE_PX = 6.5, 3.0
_DENSE_PX, _THREAD_DENSE_PX = 3.0, 5.0
_CHAMFER_CLEAR, _RIM_CLEAR = 1.15, 1.0
"""From which radius on, in those of the rim, the face beside it is seen."""
_CLEAR_PX = 3.0


@dataclass(frozen=True, slots=True)
class Task:
    """A located rim with the pixels that its model describes."""

    sight: Sight
    hole: Hole
    patch: PlanePatch
    pixels: RimPixels
    middle_px: Array
    """Where the rim was located, shape (2,)."""
    centre: Array
    """Start in plane units, shape (2,)."""
    radius: float
    """Start in plane units."""
    nominal: float
    """Nominal radius in plane units."""

    def across_lay(self) -> Array | None:
        """Across the lay of the face beside the rim, shape (2,); None without one."""
        if self.hole.countersink_m is not None:
            return None
        clear = _CHAMFER_CLEAR if self.hole.kind == "thread" else _RIM_CLEAR
        clear_px = clear * self.radius / self.patch.unit_px + _CLEAR_PX
        return lay_across(self.sight.image, self.patch, self.middle_px, clear_px)


def task_for(sight: Sight, hole: Hole, located: Located) -> Task | Rejection:
    """The fit that a located rim asks for."""
    patch = patch_of(sight, hole, 1.0)
    if patch is None:
        return Rejection("lies outside the image")
    nominal = hole.diameter_m / 2.0 / sight.distance_m
    centre = to_plane(sight.camera, located.point_px[None], patch.normal, patch.basis)[0]
    radius = nominal * located.size_ratio
    pixels = _band(sight, hole, patch, located.point_px, radius)
    return Task(sight, hole, patch, pixels, located.point_px, centre, radius, nominal)


def _band(
    sight: Sight, hole: Hole, patch: PlanePatch, middle_px: Array, radius: float
) -> RimPixels:
    """The pixels near the rim: all where it lies, one in three where only levels are needed."""
    radius_px = radius / patch.unit_px
    inside, outside, dense = min(_BAND_INSIDE_PX, 0.5 * radius_px), BAND_OUTSIDE_PX, _DENSE_PX
    if hole.kind == "thread":
        inside, dense = _THREAD_INSIDE_PX, _THREAD_DENSE_PX
    elif hole.countersink_m is not None:
        ring_px = radius_px * (hole.countersink_m / hole.diameter_m - 1.0)
        outside = min(outside, max(2.0, 0.7 * ring_px))
    x0, y0 = np.floor(middle_px - 1.15 * radius_px - outside).astype(int)
    x1, y1 = np.ceil(middle_px + 1.15 * radius_px + outside).astype(int) + 1
    height, width = sight.image.shape
    columns, rows = np.meshgrid(
        np.arange(max(x0, 0), min(x1, width)), np.arange(max(y0, 0), min(y1, height))
    )
    # In the middle of the patch the map to the plane is linear enough to choose pixels by.
    _, jacobian = patch.from_px(middle_px[:1], middle_px[1:])
    dx, dy = columns - middle_px[0], rows - middle_px[1]
    along, across = (jacobian[i, 0, 0] * dx + jacobian[i, 1, 0] * dy for i in (0, 1))
    distance = np.hypot(along, across) / patch.unit_px - radius_px
    wanted = (distance > -inside) & (distance < outside)
    wanted &= (np.abs(distance) < dense) | ((columns + rows) % 3 == 0)
    columns, rows = columns[wanted], rows[wanted]
    points, jacobians = patch.from_px(columns.astype(float), rows.astype(float))
    grey = sight.image[rows, columns].astype(float)
    return RimPixels(points, jacobians, grey, np.stack([columns, rows]), patch.unit_px)
