"""Input of the rim fit: the pixels round a located rim, in the coordinates of its plane.

Pixels are used in a band along the rim. Outside it ends before the next edge begins: round a
countersunk bore lies a cone, whose outer edge need not be in the drawing and, since it lies nearer
to the camera than the rim, comes closer to the rim on one side.
"""

from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.plane_patch import PlanePatch, to_plane
from cellctl.vision.rim.edges import polar_profile
from cellctl.vision.rim.noise import median, robust_sigma, surface_lay
from cellctl.vision.rim.roi import BAND_OUTSIDE_PX, LocatedRim, RimRoi
from cellctl.vision.rim.shape import RimPixels
from cellctl.vision.rim.spread import ImageSpread

_BAND_INSIDE_PX, _DENSE_PX = 6.5, 2.5
"""Width of the band inside the rim, and of the strip on either side of its edge of which every
pixel is used. An edge is blurred over one or two pixels; beyond the strip there are levels only."""
_INSIDE_RING_PX, _BESIDE_RING_PX = 3.0, 3.5
"""Width of the band inside a rim that has a ring, and of the band beyond the ring. The ring itself
tells most of what is to be learnt; the turns of a thread farther inside only disturb the fit."""
_CLEAR_PX = 3.0
"""The face is judged only from this far outside the rim on, beyond its blur."""
_MARGIN_PX = 1.0
"""Distance by which the located centre may still be off."""
_LOOK_PX = 9.0
"""Distance outside a bore up to which the outer edge of its cone is looked for."""
_EDGE_PX, _LEAST_OUTSIDE_PX = 2.5, 1.0
"""Distance that the band keeps from that edge, and the least width that it needs all the same."""

_AZIMUTHS, _SECTOR = 60, 5
"""Rays round the rim, and how many neighbours are averaged."""
_STEP_PX = 0.5
"""Distance of the samples along a ray."""
_OWN_EDGE_PX = 1.5
"""Distance outside the rim up to which the slope is that of the rim's own blurred edge."""
_LEAST_SHARE, _SIGMAS = 0.06, 5.0
"""Least slope that counts as an edge: as a share of the rim's own slope, and in standard deviations
of the noise. The greater one counts."""


@dataclass(frozen=True, slots=True, eq=False)
class RimFitInput:
    """A located rim with the pixels that its model describes."""

    roi: RimRoi
    patch: PlanePatch
    pixels: RimPixels
    middle_px: Array
    """Raw pixel of the located centre, shape (2,)."""
    centre: Array
    """Start of the fit in plane units, shape (2,)."""
    radius: float
    """Start of the fit in plane units."""
    clear_px: float
    """Typical distance from the rim to the next edge outside of it; infinite when none is near."""

    def across_lay(self) -> Array | None:
        """Unit vector across the lay of the face beside the rim, shape (2,); None without one."""
        if self.roi.kind.cone:
            return None
        begins_px = self.roi.kind.face_begins_radii * self.radius / self.patch.unit_px
        return surface_lay(self.roi.image, self.patch, self.middle_px, begins_px + _CLEAR_PX)


@dataclass(frozen=True, slots=True, eq=False)
class _Band:
    """Which pixels of a rim are used, by their distance from it in px."""

    inside: float
    dense: float
    """Every pixel counts up to this distance, one in three beyond it, where only the levels of the
    light are needed."""
    beyond: Array
    """Width of the band outside the rim, at evenly spaced azimuths."""


def fit_input(
    roi: RimRoi, located: LocatedRim, spread: ImageSpread, ring_px: float | None = None
) -> RimFitInput:
    """Prepare the fit of a located rim; raises ``HoleMissing`` at the border of the image.

    ``spread`` is how the image spreads light. With ``ring_px``, the width of a ring round the rim,
    the band reaches beyond the ring and covers little of what lies inside.
    """
    patch = roi.patch_or_refuse(_MARGIN_PX + (ring_px or 0.0))
    centre = to_plane(roi.camera, located.point_px[None], patch.normal, patch.basis)[0]
    radius = roi.nominal_radius * located.size_ratio
    radius_px = radius / patch.unit_px
    clear_px = np.full(1, np.inf)
    if ring_px is not None:
        beyond = np.full(1, ring_px + _BESIDE_RING_PX)
        band = _Band(_INSIDE_RING_PX, ring_px + _INSIDE_RING_PX, beyond)
    else:
        if roi.kind.cone:
            clear_px = clearance_px(roi.image, patch, centre, radius)
        # Pixels of the outer edge of a cone would be taken for the light of the cone, and shift the
        # rim.
        beyond = np.clip(clear_px - _EDGE_PX, _LEAST_OUTSIDE_PX, BAND_OUTSIDE_PX)
        band = _Band(min(_BAND_INSIDE_PX, 0.5 * radius_px), _DENSE_PX, beyond)
    pixels = replace(_pixels(roi.image, patch, located.point_px, radius_px, band), spread=spread)
    return RimFitInput(roi, patch, pixels, located.point_px, centre, radius, median(clear_px))


def clearance_px(image: Image, patch: PlanePatch, centre: Array, radius: float) -> Array:
    """Distance from the rim to the next edge outside of it, at even azimuths, shape (60,), px.

    ``centre`` and ``radius`` in plane units. Infinite where no edge lies within reach.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False)
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    widths_px = np.arange(-2.0, _LOOK_PX + _STEP_PX, _STEP_PX)
    profile = polar_profile(image, patch, centre, rays, radius + widths_px * patch.unit_px)
    # A moving mean over neighbouring azimuths, by differences of cumulative sums.
    wrapped = np.concatenate([profile[-(_SECTOR // 2) :], profile, profile[: _SECTOR // 2]])
    sums = np.cumsum(np.vstack([np.zeros_like(wrapped[:1]), wrapped]), axis=0)
    slope = np.gradient((sums[_SECTOR:] - sums[:-_SECTOR]) / _SECTOR, axis=1) / _STEP_PX
    # The rim's own edge is the yardstick, because the contrast of a part is not known beforehand.
    own = widths_px <= _OWN_EDGE_PX
    outer = slope[:, ~own]
    limit = _LEAST_SHARE * median(np.abs(slope[:, own]).max(axis=1))
    limit = max(limit, _SIGMAS * robust_sigma((outer - np.median(outer, axis=0)).ravel()))
    return _first_edges(np.abs(outer), widths_px[~own], limit)


def _first_edges(steepness: Array, widths_px: Array, limit: float) -> Array:
    """Places of the first peaks of the steepness (k, n) above the limit, shape (k,).

    The flank of the rim's own edge reaches into the profile: a peak counts only after a valley.
    """
    before, here, after = steepness[:, :-2], steepness[:, 1:-1], steepness[:, 2:]
    past_valley = np.logical_or.accumulate(here > before, axis=1)
    peak = past_valley & (here >= before) & (here > after) & (here > limit)
    return np.where(peak.any(axis=1), widths_px[1:-1][np.argmax(peak, axis=1)], np.inf)


def _pixels(
    image: Image, patch: PlanePatch, middle_px: Array, radius_px: float, band: _Band
) -> RimPixels:
    outside = float(band.beyond.max())
    x0, y0 = np.floor(middle_px - 1.15 * radius_px - outside).astype(int)
    x1, y1 = np.ceil(middle_px + 1.15 * radius_px + outside).astype(int) + 1
    height, width = image.shape
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
    # Only pixels near an edge carry its position. Farther away they tell the levels of the light,
    # which are averages, so a third of them does and the fit is faster.
    wanted &= (np.abs(distance) < band.dense) | ((columns + rows) % 3 == 0)
    columns, rows = columns[wanted], rows[wanted]
    points, jacobians = patch.from_px(columns.astype(float), rows.astype(float))
    grey = image[rows, columns].astype(float)
    return RimPixels(points, jacobians, grey, patch.unit_px)
