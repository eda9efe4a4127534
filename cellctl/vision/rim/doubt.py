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
_RING_WIDTHS_PX = (1.0, 2.0, 3.5)


class Doubt:
    """Score tests on one fit of one image."""

    def __init__(self, bare: Fitted) -> None:
        self._solution, self._shape = bare.solution, bare.shapes[0]
        self._pixels, self._unit_px = bare.problem.views[0].pixels, bare.problem.unit_px
        self._covariance = bare.solution.covariance
        x, y = (self._pixels.points - self._shape.centre[:, None]) / self._shape.radius
        self._radius = np.maximum(np.sqrt(x * x + y * y), 1e-6)
        self._cos, self._sin = x / self._radius, y / self._radius

    def likely_wall(self, ratios: Sequence[float]) -> tuple[float, float]:
        """The wall ratio that would explain most of the misfit of a fit without a wall, and its
        gain, as if a wall of unknown, even grey were seen."""
        seen = outside_walls(self._pixels, self._shape, ratios) - self._solution.outside
        gains = self._gain_of_each(seen)
        best = int(np.argmax(gains))
        return ratios[best], float(gains[best])

    def uneven_inside(self) -> bool:
        """Whether the inside of the rim is not even."""
        below, cos, sin = 1.0 - self._radius, self._cos, self._sin
        rows = np.stack([cos, sin, below, below * cos, below * sin, below * below])
        return self._gain((1.0 - self._solution.outside) * rows) > _DOUBT_GAIN

    def ring(self) -> bool:
        """Whether a narrow ring of another grey lies round the rim."""
        return self.ring_gain() > _DOUBT_GAIN

    def ring_gain(self) -> float:
        """What a narrow ring of another grey round the rim would explain at most."""
        around = np.stack([np.ones_like(self._cos), self._cos, self._sin])
        radii = self._shape.radius + np.array(_RING_WIDTHS_PX) * self._unit_px
        beyond = outside_circles(self._pixels, self._shape, radii)
        return max(self._gain(around * ring) for ring in self._solution.outside - beyond)

    def _gain(self, rows: Array) -> float:
        """Fall of the squares if ``rows`` (k, n) were added to the model with free weights."""
        solution = self._solution
        weighted = solution.noise.weigh(rows)
        shared = weighted @ solution.design.T
        size, scale = with_unit_diagonal(weighted @ rows.T)
        size -= (shared @ self._covariance @ shared.T) / (scale[:, None] * scale)
        add_to_diagonal(size, _RIDGE)
        score = (weighted @ solution.residuals) / scale
        return float(score @ np.linalg.solve(size, score))

    def _gain_of_each(self, rows: Array) -> Array:
        """The same for each of ``rows`` (k, n) alone, shape (k,)."""
        solution = self._solution
        weighted = solution.noise.weigh(rows)
        shared = weighted @ solution.design.T
        size = (weighted * rows).sum(axis=1) - ((shared @ self._covariance) * shared).sum(axis=1)
        squares = (weighted @ solution.residuals) ** 2
        return np.where(size > 1e-6, squares / np.maximum(size, 1e-6), 0.0)
