"""Sub-pixel edge points across a rim, and the circle that most azimuths agree on.

Works in the coordinates of the rim's plane, where lens distortion and perspective are gone and the
rim is a circle. Gives the start of the fine fit, and the evidence that there is a rim at all.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.camera import PlanePatch, distort
from cellctl.vision.stereo_head import CameraModel

_AZIMUTHS = 96
_STEP_PX = 0.5
_TRIALS = 160
_TOLERANCE_PX = 0.8
_WEAKEST = 0.2
"""Edges below this share of the typical strength do not count."""


@dataclass(frozen=True, slots=True)
class EdgeCircle:
    """A circle in the plane, supported by edge points."""

    centre: Array
    """Shape (2,), plane units."""
    radius: float
    support: float
    """Share of the azimuths with an edge point within the tolerance."""
    residual_px: float
    """Robust standard deviation of the supporting points from the circle."""
    points_px: Array
    """Supporting edge points in the raw image, shape (n, 2)."""


@dataclass(frozen=True, slots=True)
class _Edges:
    points: Array
    strength: Array
    azimuth: Array


def edge_circle(
    smoothed: Array,
    patch: PlanePatch,
    camera: CameraModel,
    centre: Array,
    radius: float,
    *,
    reach_px: float,
    radius_tolerance: float,
    bright: bool = False,
) -> EdgeCircle | None:
    """Find the rim near a start that may be off by ``reach_px``; None without a clear circle.

    ``smoothed`` is the patch's grey values after a light blur. ``radius`` is the expected one;
    circles that differ from it by more than ``radius_tolerance`` (a ratio) are not considered.
    """
    px = patch.unit_px
    reach = reach_px * px + radius_tolerance * radius
    edges = _radial_edges(smoothed, patch, camera, centre, radius, reach, px, bright=bright)
    if len(edges.points) < 12:
        return None
    start = _consensus(edges, radius, radius_tolerance, px)
    if start is None:
        return None
    return _refined(edges, start, patch, camera, px)


def plane_to_px(camera: CameraModel, patch: PlanePatch, points: Array) -> Array:
    """Raw pixels, shape (n, 2), of points of the patch's plane, shape (n, 2)."""
    rays = patch.normal + points @ patch.basis
    return distort(camera, rays[:, :2] / rays[:, 2:])


def _radial_edges(
    smoothed: Array,
    patch: PlanePatch,
    camera: CameraModel,
    centre: Array,
    radius: float,
    reach: float,
    px: float,
    *,
    bright: bool,
) -> _Edges:
    angles = np.arange(_AZIMUTHS) * (2.0 * np.pi / _AZIMUTHS)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    step = _STEP_PX * px
    first = max(radius - reach, 2.0 * px)
    radii = np.arange(first, radius + reach + step, step)
    grid = centre + directions[:, None, :] * radii[None, :, None]
    pixels = plane_to_px(camera, patch, grid.reshape(-1, 2)) - patch.origin_px
    profile = _bilinear(smoothed, pixels).reshape(_AZIMUTHS, len(radii))
    slope = np.gradient(profile, axis=1) * (-1.0 if bright else 1.0)
    middle, before, after = slope[:, 1:-1], slope[:, :-2], slope[:, 2:]
    typical = float(np.median(slope.max(axis=1)))
    peak = (middle >= before) & (middle > after) & (middle > max(_WEAKEST * typical, 0.4))
    which, index = np.nonzero(peak)
    value, low, high = (part[which, index] for part in (middle, before, after))
    shift = 0.5 * (low - high) / np.minimum(low - 2.0 * value + high, -1e-9)
    distance = radii[index + 1] + np.clip(shift, -0.5, 0.5) * step
    return _Edges(centre + directions[which] * distance[:, None], value, which)


def _bilinear(image: Array, pixels: Array) -> Array:
    height, width = image.shape
    x = np.clip(pixels[:, 0], 0.0, width - 1.001)
    y = np.clip(pixels[:, 1], 0.0, height - 1.001)
    column, row = x.astype(int), y.astype(int)
    u, v = x - column, y - row
    top = image[row, column] * (1 - u) + image[row, column + 1] * u
    bottom = image[row + 1, column] * (1 - u) + image[row + 1, column + 1] * u
    return np.asarray(top * (1 - v) + bottom * v)


def _consensus(
    edges: _Edges, radius: float, radius_tolerance: float, px: float
) -> tuple[Array, float] | None:
    """Best of many circles through three edge points, by the azimuths that agree."""
    count = len(edges.points)
    picks = np.random.default_rng(count).integers(0, count, size=(_TRIALS, 3))
    centres, radii = _circles(edges.points[picks])
    plausible = np.abs(radii / radius - 1.0) < radius_tolerance
    centres, radii = centres[plausible], radii[plausible]
    if len(radii) == 0:
        return None
    offsets = np.linalg.norm(edges.points[None] - centres[:, None], axis=2) - radii[:, None]
    closeness = np.maximum(1.0 - (offsets / (_TOLERANCE_PX * px)) ** 2, 0.0)
    best = int(np.argmax(closeness.sum(axis=1)))
    return centres[best], float(radii[best])


def _circles(triples: Array) -> tuple[Array, Array]:
    """Circles through three points each, shape (n, 3, 2); degenerate ones get radius infinity."""
    a, b, c = triples[:, 0], triples[:, 1], triples[:, 2]
    ab, ac = b - a, c - a
    cross = 2.0 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])
    safe = np.where(np.abs(cross) < 1e-18, 1e-18, cross)
    ab2, ac2 = (ab**2).sum(axis=1), (ac**2).sum(axis=1)
    offset = (
        np.column_stack([ac[:, 1] * ab2 - ab[:, 1] * ac2, ab[:, 0] * ac2 - ac[:, 0] * ab2])
        / safe[:, None]
    )
    return a + offset, np.linalg.norm(offset, axis=1)


def _refined(
    edges: _Edges, start: tuple[Array, float], patch: PlanePatch, camera: CameraModel, px: float
) -> EdgeCircle | None:
    """Iteratively re-weighted geometric circle fit."""
    centre, radius = start
    tolerance = 1.5 * _TOLERANCE_PX * px
    for _ in range(8):
        offset = edges.points - centre
        length = np.linalg.norm(offset, axis=1)
        residual = length - radius
        weight = np.maximum(1.0 - (residual / tolerance) ** 2, 0.0) ** 2
        if np.count_nonzero(weight) < 8:
            return None
        design = np.column_stack([offset / length[:, None], np.ones(len(length))])
        weighted = design * weight[:, None]
        step = np.linalg.solve(weighted.T @ design, weighted.T @ residual)
        centre, radius = centre + step[:2], radius + step[2]
        spread = 1.4826 * float(np.median(np.abs(residual[weight > 0])))
        tolerance = min(tolerance, max(4.0 * spread, 0.25 * px))
    near = np.abs(np.linalg.norm(edges.points - centre, axis=1) - radius) < _TOLERANCE_PX * px
    points_px = plane_to_px(camera, patch, edges.points[near])
    support = len(np.unique(edges.azimuth[near])) / _AZIMUTHS
    return EdgeCircle(centre, float(radius), support, spread / px, points_px)
