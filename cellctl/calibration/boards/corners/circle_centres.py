"""Centres of circles in images: ellipses through sub-pixel edge points, and what they are off.

The centre of the ellipse that a circle is seen as is not where the centre of the circle is seen.
Perspective moves it, by about f R² sin(a) cos(a) / Z² for a board tilted by a (Heikkilä 2000, IEEE
TPAMI 22(10)), and so does the distortion of the lens, which makes the ellipse an egg. Both
are taken away by doing with the drawing what is done with the image: the rim of each circle is
projected, lens included, and the same ellipse is fitted to it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter

from cellctl.calibration.boards.projection import project
from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image

_AZIMUTHS = 64
_ANGLES: Array = np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False)
_UNIT: Array = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])
_REACH_OF_RADIUS = 0.4
"""How far from the expected rim its edge is searched: neighbours are at least as far again."""
_LEAST_REACH_PX, _STEP_PX = 2.0, 0.5
"""Least reach on a small circle, and the distance of the samples along a ray."""
_PASSES = 2
"""The first finds the rim from a reduced image, the second measures across it."""
_OUTLIER = 4.0
"""Edge points further off, in robust standard deviations, do not count: a scratch, a cable."""
_SMALLEST_SIGMA_PX = 0.02
"""Scatter that edge points are believed to have at least: otherwise good points would be thrown
away where by chance all of them agree."""
_FEWEST = 24
"""Edge points of a rim that is taken."""


@dataclass(frozen=True, slots=True, eq=False)
class Rims:
    """Ellipses of n circles, raw pixels."""

    centres: Array
    """Shape (n, 2)."""
    half_axes: Array
    """Columns are the half axes as vectors, shape (n, 2, 2)."""


def measured_rims(image: Image, start: Rims, *, bright: bool) -> Rims | None:
    """Ellipses through the edges near ``start``; None when a rim has no clear edge all round.

    ``bright`` says that the circles are brighter than the board.
    """
    # Smoothing moves a curved edge along its radius only, never the centre.
    smooth = np.asarray(cv2.GaussianBlur(image.astype(np.float32), (0, 0), 1.0))
    # By a cubic spline: between linearly interpolated pixels the slope jumps, and its peak would
    # stick to the grid of the pixels.
    spline = spline_filter(smooth, order=3, output=np.float32)
    rims = start
    for _ in range(_PASSES):
        found = _through_edges(spline, rims, -1.0 if bright else 1.0)
        if found is None:
            return None
        rims = found
    return rims


def centre_offsets(
    camera: Array, camera_R_board: Array, shift_m: Array, centres_m: Array, radius_m: float
) -> Array:
    """Centre of the image's ellipse less the image of the centre, px, shape (n, 2).

    ``camera`` are the numbers of ``projection``; the board is at ``camera_R_board`` (3, 3) and
    ``shift_m`` (3,), the circles of ``radius_m`` at ``centres_m`` (n, 3) in its frame.
    """
    rim = np.column_stack([_UNIT * radius_m, np.zeros(_AZIMUTHS)])
    points = (centres_m[:, None, :] + rim).reshape(-1, 3) @ camera_R_board.T + shift_m
    pixels = project(camera, points).pixels.reshape(-1, _AZIMUTHS, 2)
    ellipses = _ellipses(pixels, np.ones(pixels.shape[:2]))
    return np.asarray(
        ellipses.centres - project(camera, centres_m @ camera_R_board.T + shift_m).pixels
    )


def _through_edges(spline: NDArray[np.float32], rims: Rims, sign: float) -> Rims | None:
    minor_px = np.linalg.norm(rims.half_axes, axis=1).min(axis=1)
    reach_px = np.maximum(_REACH_OF_RADIUS * minor_px, _LEAST_REACH_PX)
    steps = int(np.ceil(2 * reach_px.max() / _STEP_PX)) + 1
    # Along rays through the centre, in units of the ellipse: where the rim is expected, it is 1.
    scales = 1 + np.linspace(-1, 1, steps) * (reach_px / minor_px)[:, None]
    rays = _UNIT @ rims.half_axes.transpose(0, 2, 1)
    places = rims.centres[:, None, None] + rays[:, :, None] * scales[:, None, :, None]
    rows_columns = np.moveaxis(places[..., ::-1], 3, 0)
    grey = map_coordinates(spline, rows_columns, order=3, mode="nearest", prefilter=False)
    slope = sign * np.gradient(grey, axis=2)
    peak = slope[:, :, 1:-1].argmax(axis=2) + 1
    before, middle, after = (
        np.take_along_axis(slope, (peak + shift)[:, :, None], axis=2)[:, :, 0]
        for shift in (-1, 0, 1)
    )
    # Vertex of the parabola through three slopes.
    vertex = 0.5 * (before - after) / np.minimum(before - 2 * middle + after, -1e-9)
    unit = scales[:, 1] - scales[:, 0]
    where = scales[:, :1] + (peak + np.clip(vertex, -0.5, 0.5)) * unit[:, None]
    points = rims.centres[:, None] + rays * where[:, :, None]
    size = np.array(spline.shape[::-1])
    inside = ((points >= 0) & (points <= size - 1)).all(axis=2)
    weight = (middle > 0.3 * np.median(middle, axis=1)[:, None]) & inside
    return _robust(points, weight.astype(float))


def _robust(points: Array, weight: Array) -> Rims | None:
    rims = None
    for _ in range(3):
        if (weight.sum(axis=1) < _FEWEST).any():
            return None
        rims = _ellipses(points, weight)
        off_px = _distances(rims, points)
        spread = np.median(np.abs(off_px), axis=1) / 0.6745
        limit = _OUTLIER * np.maximum(spread, _SMALLEST_SIGMA_PX)
        weight = weight * (np.abs(off_px) <= limit[:, None])
    return rims


def _distances(rims: Rims, points: Array) -> Array:
    """Distance of points (n, k, 2) from their rim, to first order, px."""
    local = np.linalg.solve(rims.half_axes[:, None], (points - rims.centres[:, None])[..., None])
    radius = np.maximum(np.linalg.norm(local[..., 0], axis=2), 1e-9)
    size = np.linalg.norm(points - rims.centres[:, None], axis=2)
    return np.asarray(size * (1 - 1 / radius))


def _ellipses(points: Array, weight: Array) -> Rims:
    """Least-squares ellipses through points (n, k, 2); algebraic, then weighted as distances."""
    # Shifted and scaled for each circle, so that all columns are of one size.
    total = weight.sum(axis=1)[:, None]
    middle = (points * weight[..., None]).sum(axis=1) / total
    spread = np.sqrt((((points - middle[:, None]) ** 2).sum(axis=2) * weight).sum(axis=1))
    scale = (spread / np.sqrt(total[:, 0]))[:, None]
    x, y = np.moveaxis((points - middle[:, None]) / scale[:, None], 2, 0)
    one = np.ones_like(x)
    design = np.stack([x * x - y * y, 2 * x * y, x, y, one], axis=2)
    used = weight
    for _ in range(2):
        columns = design * used[..., None]
        normal = columns.transpose(0, 2, 1) @ design
        right = -np.einsum("nkc,nk->nc", columns, y * y)
        a, b, d, e, f = np.moveaxis(np.linalg.solve(normal, right[..., None])[..., 0], 1, 0)
        # The value of the conic is distance times gradient, so the gradient is divided out.
        by_x = 2 * (a[:, None] * x + b[:, None] * y) + d[:, None]
        by_y = 2 * (b[:, None] * x + (1 - a)[:, None] * y) + e[:, None]
        used = weight / np.maximum(by_x**2 + by_y**2, 1e-12)
    quadratic = np.stack([np.stack([a, b], axis=1), np.stack([b, 1 - a], axis=1)], axis=1)
    linear = np.stack([d, e], axis=1)
    centre = -0.5 * np.linalg.solve(quadratic, linear[..., None])[..., 0]
    level = np.einsum("nk,nkl,nl->n", centre, quadratic, centre) - f
    values, vectors = np.linalg.eigh(quadratic)
    # Edge points that are no ellipse give a negative square: the axes then have no length.
    squares = level[:, None] / values
    axes = np.sqrt(np.maximum(squares, 1e-12)) * scale
    return Rims(middle + centre * scale, vectors * axes[:, None, :])
