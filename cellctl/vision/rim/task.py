"""What is to be fitted: the pixels round a located rim, in the coordinates of its plane."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.features import Hole
from cellctl.vision.plane_patch import PlanePatch, to_plane
from cellctl.vision.rim.lay import lay_across
from cellctl.vision.rim.model import RimPixels
from cellctl.vision.rim.robust import median
from cellctl.vision.rim.sight import BAND_OUTSIDE_PX, Located, Rejection, Sight, patch_of
from cellctl.vision.rim.surround import clear_widths_px

_BAND_INSIDE_PX, _DENSE_PX = 6.5, 2.5
_INSIDE_RING_PX, _BESIDE_RING_PX = 3.0, 3.5
_CHAMFER_CLEAR, _RIM_CLEAR = 1.15, 1.0
"""From which radius on, in those of the rim, the face beside it is seen."""
_CLEAR_PX = 3.0
_MARGIN_PX = 1.0
_LOOK_PX = 9.0
"""How far outside a bore the outer edge of its cone is looked for."""
_EDGE_PX, _LEAST_OUTSIDE_PX = 2.5, 1.0
"""Distance kept from that edge, but for the least that a rim needs."""


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
    clear_px: float
    """Typical distance from the rim to the next edge outside of it; infinite when none is near."""

    def across_lay(self) -> Array | None:
        """Across the lay of the face beside the rim, shape (2,); None without one."""
        if self.hole.kind == "countersink":
            return None
        clear = _CHAMFER_CLEAR if self.hole.kind == "thread" else _RIM_CLEAR
        clear_px = clear * self.radius / self.patch.unit_px + _CLEAR_PX
        return lay_across(self.sight.image, self.patch, self.middle_px, clear_px)


@dataclass(frozen=True, slots=True)
class _Band:
    """Which pixels of a rim are used, by their distance from it in px."""

    inside: float
    dense: float
    """All of them up to here, one in three beyond, where only levels are needed."""
    beyond: Array
    """How far outside, at even azimuths."""


def task_for(
    sight: Sight, hole: Hole, located: Located, ring_px: float | None = None
) -> Task | Rejection:
    """The fit that a located rim asks for.

    With ``ring_px`` as the width of a ring round the rim, and then little of what lies inside.
    """
    patch = patch_of(sight, hole, _MARGIN_PX + (ring_px or 0.0))
    if patch is None:
        return Rejection("lies outside the image")
    nominal = hole.diameter_m / 2.0 / sight.distance_m
    centre = to_plane(sight.camera, located.point_px[None], patch.normal, patch.basis)[0]
    radius = nominal * located.size_ratio
    radius_px = radius / patch.unit_px
    clear_px = np.full(1, np.inf)
    if hole.kind == "countersink" and ring_px is None:
        clear_px = clear_widths_px(sight.image, patch, centre, radius, _LOOK_PX)
    if ring_px is None:
        beyond = np.clip(clear_px - _EDGE_PX, _LEAST_OUTSIDE_PX, BAND_OUTSIDE_PX)
        band = _Band(min(_BAND_INSIDE_PX, 0.5 * radius_px), _DENSE_PX, beyond)
    else:
        beyond = np.full(1, ring_px + _BESIDE_RING_PX)
        band = _Band(_INSIDE_RING_PX, ring_px + _INSIDE_RING_PX, beyond)
    pixels = _pixels(sight, patch, located.point_px, radius_px, band)
    clear = median(clear_px)
    return Task(sight, hole, patch, pixels, located.point_px, centre, radius, nominal, clear)


def _pixels(
    sight: Sight, patch: PlanePatch, middle_px: Array, radius_px: float, band: _Band
) -> RimPixels:
    outside = float(band.beyond.max())
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
    turns = np.arctan2(across, along) / (2.0 * np.pi)
    sector = np.rint(turns * len(band.beyond)).astype(int) % len(band.beyond)
    wanted = (distance > -band.inside) & (distance < band.beyond[sector])
    wanted &= (np.abs(distance) < band.dense) | ((columns + rows) % 3 == 0)
    columns, rows = columns[wanted], rows[wanted]
    points, jacobians = patch.from_px(columns.astype(float), rows.astype(float))
    grey = sight.image[rows, columns].astype(float)
    return RimPixels(points, jacobians, grey, np.stack([columns, rows]), patch.unit_px)
