"""Sub-pixel edge points across a rim, and the circle that most azimuths agree on.

Works in the coordinates of the rim's plane, where lens distortion and perspective are gone and the
rim is a circle. Gives the start of the fine fit, and the evidence that there is a rim at all.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.plane_patch import PlanePatch
from cellctl.vision.rim.noise import median, robust_sigma

_AZIMUTHS = 64
"""Rays round the rim. A rim of 20 px has a circumference of 126 px: two pixels to a ray."""
_STEP_PX = 0.5
"""Distance of the samples along a ray."""
_TRIALS = 70
"""Random triples of edge points. With half of the points on the rim one triple in eight is clean:
that none of 70 is happens once in ten thousand rims."""
_FEWEST = 10
"""Least number of edge points of a circle."""
_REFINEMENTS = 3
"""Rounds of the re-weighted fit; the circle only has to start the fine fit."""
_TOLERANCE_PX = 0.8
"""An edge point within this distance of a circle agrees with it."""
_WEAKEST = 0.2
"""Edges below this share of the typical strength do not count."""
_LEAST_SLOPE_GREY = 0.4
"""Least change of grey in one step along a ray: less is noise."""

_ANGLES: Array = np.linspace(0.0, 2.0 * np.pi, _AZIMUTHS, endpoint=False)
_DIRECTIONS: Array = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


@dataclass(frozen=True, slots=True, eq=False)
class EdgeCircle:
    """A circle in the plane, supported by edge points."""

    centre: Array
    """Shape (2,), plane units."""
    radius: float
    support: float
    """Share of the azimuths with an edge point within the tolerance."""


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    points: Array
    azimuth: NDArray[np.intp]
    slope: Array


def edge_circle(
    image: Image,
    patch: PlanePatch,
    centre: Array,
    radius: float,
    *,
    reach_px: float,
    radius_tolerance: float,
    bright: bool = False,
) -> EdgeCircle | None:
    """Find the rim near a start that may be off by ``reach_px``; None without a clear circle.

    ``centre`` and ``radius`` in plane units; circles that differ from the radius by more than
    ``radius_tolerance`` (a ratio) are not considered. The patch must lie inside the image.
    """
    reach = reach_px * patch.unit_px + radius_tolerance * radius
    edges = _radial_edges(image, patch, centre, radius, reach, sign=-1.0 if bright else 1.0)
    if len(edges.points) < _FEWEST:
        return None
    start = _consensus(edges, radius, radius_tolerance, patch.unit_px)
    return None if start is None else _refined(edges, start, patch)


def strongest_edges(
    image: Image, patch: PlanePatch, centre: Array, radius: float, reach: float, *, bright: bool
) -> Array:
    """The steepest edge in each direction within ``reach`` of a circle, shape (n, 2), n ≤ 64.

    All in plane units.
    """
    edges = _radial_edges(image, patch, centre, radius, reach, sign=-1.0 if bright else 1.0)
    order = np.argsort(-edges.slope)
    _, first = np.unique(edges.azimuth[order], return_index=True)
    return edges.points[order[first]]


def _radial_edges(
    image: Image, patch: PlanePatch, centre: Array, radius: float, reach: float, *, sign: float
) -> _Edges:
    """Peaks of the slope along rays from the centre, to a fraction of a step."""
    step = float(_STEP_PX * patch.unit_px)
    # Rays begin outside the centre: there all of them would sample the same pixels.
    first = max(radius - reach, 2.0 * step)
    radii = first + step * np.arange(int((radius + reach - first) / step) + 2)
    profile = polar_profile(image, patch, centre, _DIRECTIONS, np.asarray(radii, dtype=float))
    slope = sign * np.asarray(np.gradient(profile, axis=1))
    middle, before, after = slope[:, 1:-1], slope[:, :-2], slope[:, 2:]
    typical = median(slope.max(axis=1))
    limit = max(_WEAKEST * typical, _LEAST_SLOPE_GREY)
    peak = (middle >= before) & (middle > after) & (middle > limit)
    which, index = np.nonzero(peak)
    value, low, high = (part[which, index] for part in (middle, before, after))
    # Vertex of the parabola through the three slopes. The bound keeps a flat top from dividing by
    # zero.
    shift = 0.5 * (low - high) / np.minimum(low - 2.0 * value + high, -1e-9)
    distance = radii[index + 1] + np.clip(shift, -0.5, 0.5) * step
    return _Edges(centre + _DIRECTIONS[which] * distance[:, None], which, value)


def polar_profile(
    image: Image, patch: PlanePatch, centre: Array, directions: Array, radii: Array
) -> Array:
    """Grey values along rays from the centre, lightly blurred, shape (rays, radii)."""
    grid = centre + directions[:, None, :] * radii[None, :, None]
    return _sample(image, patch.to_px(grid.reshape(-1, 2))).reshape(len(directions), len(radii))


def _sample(image: Image, pixels: Array) -> Array:
    """Lightly blurred grey values at raw pixels, bilinear."""
    x0, y0 = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - 3, 0)
    x1, y1 = np.ceil(pixels.max(axis=0)).astype(int) + 4
    cut = image[y0:y1, x0:x1].astype(np.float32)
    smooth = np.asarray(cv2.GaussianBlur(cut, (0, 0), 1.0), dtype=float)
    return _bilinear(smooth, pixels - (x0, y0))


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
    """Best of many circles through three edge points, by the edge points that agree (MSAC)."""
    count = len(edges.points)
    # The seed makes the same image give the same result.
    picks = np.random.default_rng(count).integers(0, count, size=(_TRIALS, 3))
    centres, radii = _circles(edges.points[picks])
    plausible = np.abs(radii / radius - 1.0) < radius_tolerance
    centres, radii = centres[plausible], radii[plausible]
    if len(radii) == 0:
        return None
    # Each edge point counts by how close it is (MSAC), not by yes or no: among circles with the
    # same number of points the one through their middle wins.
    dx = edges.points[:, 0] - centres[:, :1]
    dy = edges.points[:, 1] - centres[:, 1:]
    offsets = (np.sqrt(dx * dx + dy * dy) - radii[:, None]) / (_TOLERANCE_PX * px)
    closeness = np.maximum(1.0 - offsets * offsets, 0.0)
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


def _refined(edges: _Edges, start: tuple[Array, float], patch: PlanePatch) -> EdgeCircle | None:
    """Iteratively re-weighted geometric circle fit, with Tukey's biweight.

    The tolerance shrinks with the scatter of the points, so that a wall or a chamfer close to the
    rim loses its influence from step to step.
    """
    centre, radius = start
    px = patch.unit_px
    tolerance = 1.5 * _TOLERANCE_PX * px
    near = np.linalg.norm(edges.points - centre, axis=1) - radius
    points = edges.points[np.abs(near) < 2.0 * tolerance]
    for _ in range(_REFINEMENTS):
        offset = points - centre
        length = np.linalg.norm(offset, axis=1)
        residual = length - radius
        weight = np.maximum(1.0 - (residual / tolerance) ** 2, 0.0) ** 2
        if np.count_nonzero(weight) < _FEWEST:
            return None
        design = np.column_stack([offset / length[:, None], np.ones(len(length))])
        weighted = design * weight[:, None]
        step = np.linalg.solve(weighted.T @ design, weighted.T @ residual)
        centre, radius = centre + step[:2], radius + float(step[2])
        # Not below a quarter of a pixel: on a clean rim the tolerance would otherwise shrink until
        # chance decides which points are left.
        spread = robust_sigma(residual[weight > 0])
        tolerance = min(tolerance, max(4.0 * spread, 0.25 * px))
    close = np.abs(np.linalg.norm(edges.points - centre, axis=1) - radius) < _TOLERANCE_PX * px
    support = len(np.unique(edges.azimuth[close])) / _AZIMUTHS
    return EdgeCircle(centre, radius, support)
