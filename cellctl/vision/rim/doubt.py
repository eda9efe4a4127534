"""Whether the pixels at a rim contradict a simple model of it.

Score tests (Rao): how far the weighted squares would fall if more were modelled, with shape and
light free to follow to first order. Nothing has to be fitted for them.
"""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.fit import Fitted
from cellctl.vision.rim.matrix import add_to_diagonal, with_unit_diagonal
from cellctl.vision.rim.model import outside_circles, outside_walls

_DOUBT_GAIN = 15.0
"""Fall of the squares by up to six terms that two rims in a hundred show by chance."""
_RIDGE = 1e-6
"""Keeps terms that are modelled already from counting."""
_RING_WIDTHS_PX = (1.0, 2.0, 3.0, 4.5)


def likely_wall(bare: Fitted, ratios: Sequence[float]) -> tuple[float, float]:
    """The wall ratio that would explain most of the misfit of a rim without a wall, and its gain.

    As if a wall of unknown, even grey were seen.
    """
    pixels, shape = bare.problem.views[0].pixels, bare.shapes[0]
    gains = _Score(bare).of_each(outside_walls(pixels, shape, ratios) - bare.solution.outside)
    best = int(np.argmax(gains))
    return ratios[best], float(gains[best])


def contradicts_dark_inside(bare: Fitted) -> bool:
    """Whether the inside of a rim is not even."""
    radius, cos, sin = _polar(bare)
    below = 1.0 - radius
    rows = np.stack([cos, sin, below, below * cos, below * sin, below * below])
    return _Score(bare).of((1.0 - bare.solution.outside) * rows) > _DOUBT_GAIN


def contradicts_sharp_rim(bare: Fitted) -> bool:
    """Whether a narrow ring of another grey lies round a rim."""
    _, cos, sin = _polar(bare)
    around, shape, score = np.stack([np.ones_like(cos), cos, sin]), bare.shapes[0], _Score(bare)
    radii = shape.radius + np.array(_RING_WIDTHS_PX) * bare.problem.unit_px
    rings = bare.solution.outside - outside_circles(bare.problem.views[0].pixels, shape, radii)
    return max(score.of(around * ring) for ring in rings) > _DOUBT_GAIN


class _Score:
    """Falls of the squares of a fit."""

    def __init__(self, bare: Fitted) -> None:
        self._solution = bare.solution
        self._covariance = bare.solution.covariance()

    def of(self, rows: Array) -> float:
        """If ``rows`` (k, n) were added to the model with free weights."""
        solution = self._solution
        weighted = solution.noise.weigh(rows)
        shared = weighted @ solution.design.T
        size, scale = with_unit_diagonal(weighted @ rows.T)
        size -= (shared @ self._covariance @ shared.T) / (scale[:, None] * scale)
        add_to_diagonal(size, _RIDGE)
        score = (weighted @ solution.residuals) / scale
        return float(score @ np.linalg.solve(size, score))

    def of_each(self, rows: Array) -> Array:
        """If one of ``rows`` (k, n) were added, shape (k,)."""
        solution = self._solution
        weighted = solution.noise.weigh(rows)
        shared = weighted @ solution.design.T
        size = (weighted * rows).sum(axis=1) - ((shared @ self._covariance) * shared).sum(axis=1)
        squares = (weighted @ solution.residuals) ** 2
        return np.where(size > 1e-6, squares / np.maximum(size, 1e-6), 0.0)


def _polar(bare: Fitted) -> tuple[Array, Array, Array]:
    """Radius over the rim's, cosine and sine of the azimuth of every pixel, each (n,)."""
    shape = bare.shapes[0]
    x, y = (bare.problem.views[0].pixels.points - shape.centre[:, None]) / shape.radius
    radius = np.maximum(np.sqrt(x * x + y * y), 1e-6)
    return radius, x / radius, y / radius
