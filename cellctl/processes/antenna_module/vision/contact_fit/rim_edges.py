"""Sub-pixel edges of a round contact along rays from its middle, in its plane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, map_coordinates

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

DIRECTIONS = 96
"""Rays round a contact. A rim of 20 px has a circumference of 126 px, so neighbours share
pixels."""
_ANGLES: Array = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
UNIT: Array = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])
_STEP_PX = 0.5
"""Distance of the samples along a ray."""
_SMOOTH_PX = 1.0
"""Along the ray only: across it the rim is curved, and smoothing would move it inwards."""
_WEAKEST = 0.3
"""Edges below this share of the typical strength are noise or dirt."""
_MARGIN_PX = 4
"""Border of the piece of image that is sampled, for the interpolation."""


@dataclass(frozen=True, slots=True, eq=False)
class RimEdges:
    """Edge points of a rim, at most one in each direction."""

    points_m: Array
    """Points in the plane, shape (n, 2)."""
    direction: NDArray[np.intp]
    slope_grey: Array
    """Grey levels in a pixel, positive, shape (n,)."""


def rim_edges(
    image: Image,
    plane: MeasuringPlane,
    centre_m: Array,
    radius_m: float,
    *,
    share: float,
    bright: bool,
) -> RimEdges | None:
    """The steepest edge in every direction within ``share`` of the radius; None outside the image.

    ``bright``: the inside is brighter than the outside.
    """
    px_m = plane.m_per_px(centre_m)
    step_m = _STEP_PX * px_m
    # Two steps beyond the range, so that a peak at its end still has neighbours.
    reach_m = share * radius_m + 2.0 * step_m
    count = int(np.ceil(2.0 * reach_m / step_m)) + 1
    radii = radius_m + np.linspace(-reach_m, reach_m, count)
    radii = radii[radii > 0.25 * radius_m]
    profile = _profiles(image, plane, centre_m, radii)
    if profile is None:
        return None
    step = float(radii[1] - radii[0])
    sign = -1.0 if bright else 1.0
    smooth = gaussian_filter1d(profile, _SMOOTH_PX / _STEP_PX, axis=1, order=1, mode="nearest")
    return _peaks(sign * smooth / (step / px_m), radii, centre_m)


def _profiles(image: Image, plane: MeasuringPlane, centre_m: Array, radii: Array) -> Array | None:
    """Grey values along the rays, shape (directions, radii), by cubic splines."""
    grid = centre_m + UNIT[:, None, :] * radii[None, :, None]
    pixels = plane.to_px(grid.reshape(-1, 2))
    low = np.floor(pixels.min(axis=0)).astype(int) - _MARGIN_PX
    high = np.ceil(pixels.max(axis=0)).astype(int) + _MARGIN_PX + 1
    height, width = image.shape
    if low.min() < 0 or high[0] > width or high[1] > height:
        return None
    cut = image[low[1] : high[1], low[0] : high[0]].astype(float)
    values = map_coordinates(cut, (pixels - low).T[::-1], order=3, mode="mirror")
    return np.asarray(values).reshape(len(UNIT), len(radii))


def _peaks(slope: Array, radii: Array, centre_m: Array) -> RimEdges:
    """Steepest place of every ray by the vertex of the parabola through three slopes."""
    rows = np.arange(len(slope))
    top = slope[:, 1:-1].argmax(axis=1) + 1
    value, low, high = slope[rows, top], slope[rows, top - 1], slope[rows, top + 1]
    typical = float(np.median(value))
    # A steepest place at the end of the range is the flank of something else.
    good = (value > low) & (value >= high) & (value > max(_WEAKEST * typical, 1e-6))
    curve = np.minimum(low - 2.0 * value + high, -1e-12)
    shift = np.clip(0.5 * (low - high) / curve, -0.5, 0.5)
    distance = radii[top] + shift * (radii[1] - radii[0])
    points = centre_m + UNIT * distance[:, None]
    return RimEdges(points[good], rows[good], value[good])
