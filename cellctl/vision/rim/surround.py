"""How far the surface outside a rim reaches before another edge begins.

Round a countersunk bore lies a cone. Its outer edge need not be in the drawing, and since it lies
nearer to the camera than the bore's, it comes closer to the bore on one side.
"""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.plane_patch import PlanePatch
from cellctl.vision.rim.edges import polar_profile
from cellctl.vision.rim.robust import median, robust_sigma

_AZIMUTHS, _SECTOR = 60, 5
"""Rays round the rim, and how many neighbours are averaged."""
_STEP_PX = 0.5
_OWN_EDGE_PX = 1.5
_LEAST_SHARE, _SIGMAS = 0.06, 5.0
"""Slopes that count as an edge: of the rim's own slope, and over the noise."""


def clear_widths_px(
    image: Image, patch: PlanePatch, centre: Array, radius: float, reach_px: float
) -> Array:
    """Distance from the rim to the next edge outside of it, at even azimuths, shape (60,), px.

    ``centre`` and ``radius`` in plane units. Infinite where no edge lies within ``reach_px``.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False)
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    widths_px = np.arange(-2.0, reach_px + _STEP_PX, _STEP_PX)
    profile = polar_profile(image, patch, centre, rays, radius + widths_px * patch.unit_px)
    wrapped = np.concatenate([profile[-(_SECTOR // 2) :], profile, profile[: _SECTOR // 2]])
    sums = np.cumsum(np.vstack([np.zeros_like(wrapped[:1]), wrapped]), axis=0)
    slope = np.gradient((sums[_SECTOR:] - sums[:-_SECTOR]) / _SECTOR, axis=1) / _STEP_PX
    own = widths_px <= _OWN_EDGE_PX
    outer = slope[:, ~own]
    limit = _LEAST_SHARE * median(np.abs(slope[:, own]).max(axis=1))
    limit = max(limit, _SIGMAS * robust_sigma((outer - np.median(outer, axis=0)).ravel()))
    return _first_edges(np.abs(outer), widths_px[~own], limit)


def _first_edges(steepness: Array, widths_px: Array, limit: float) -> Array:
    """Where the steepness (k, n) first rises to a peak above the limit, past the rim's own decline,
    shape (k,)."""
    before, here, after = steepness[:, :-2], steepness[:, 1:-1], steepness[:, 2:]
    past_valley = np.logical_or.accumulate(here > before, axis=1)
    peak = past_valley & (here >= before) & (here > after) & (here > limit)
    return np.where(peak.any(axis=1), widths_px[1:-1][np.argmax(peak, axis=1)], np.inf)
