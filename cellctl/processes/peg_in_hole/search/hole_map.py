"""The map of where the hole is not: what is still believed after each touch.

Source: section 3.5 of the study of insertion by touch.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

Array = NDArray[np.float64]

_LEFT_AFTER_TOUCH = 0.02
"""Share of the probability that stays where a touch found no hole. Not 0: the arm was not exactly
where it believed to be."""
_EXHAUSTED = 0.01
"""Share of the first belief that may be left unvisited when the search is over."""
_SIGMAS_OF_P99 = 3.035
"""Radius that holds 99 % of a round Gaussian, in standard deviations of one axis."""
_FEWEST, _MOST = 61, 401
"""Cells along one side. More would be slow and no finer than the repeatability of an arm."""


class HoleMap:
    """Belief about the axis of the hole on a square grid in frame A."""

    def __init__(self, uncertainty_m: float, catch_m: float) -> None:
        """``uncertainty_m``: radius that holds the hole in 99 of 100 cases."""
        # The hole lies within the radius in 99 of 100 cases; the margin is that of section 3.5.
        self.reach_m = 1.15 * uncertainty_m
        cells = int(np.clip(np.ceil(4 * self.reach_m / catch_m), _FEWEST, _MOST)) | 1
        self.axis_m: Array = np.linspace(-self.reach_m, self.reach_m, cells)
        x, y = np.meshgrid(self.axis_m, self.axis_m, indexing="ij")
        self.points_m: Array = np.stack([x, y], axis=-1)
        """Centres of the cells, shape (n, n, 2)."""
        sigma_m = uncertainty_m / _SIGMAS_OF_P99
        radius_m = np.hypot(x, y)
        begun = np.exp(-0.5 * (radius_m / sigma_m) ** 2) * (radius_m <= self.reach_m)
        self.weights: Array = begun / begun.sum()
        self._begun = self.weights.copy()
        self._seen = np.zeros(begun.shape, dtype=bool)
        self._catch_m = catch_m

    @property
    def cell_m(self) -> float:
        """Side of a cell."""
        return float(self.axis_m[1] - self.axis_m[0])

    @property
    def exhausted(self) -> bool:
        """True when nearly nothing of what was believed at first is left to be looked at."""
        return bool(self._begun[~self._seen].sum() < _EXHAUSTED)

    def rule_out(self, way_m: Array) -> None:
        """An upright peg has been at these points (n, 2) and did not find the hole."""
        index = np.rint((way_m + self.reach_m) / self.cell_m).astype(int)
        inside = np.all((index >= 0) & (index < len(self.axis_m)), axis=1)
        if not inside.any():
            return
        free = np.ones(self.weights.shape, dtype=bool)
        free[index[inside, 0], index[inside, 1]] = False
        # Half a cell more, because a point stands for the whole cell that it lies in.
        near = distance_transform_edt(free) * self.cell_m <= self._catch_m + self.cell_m / 2
        self._seen |= near
        self._scale(np.where(near, _LEFT_AFTER_TOUCH, 1.0))

    def weigh(self, likelihood: Array) -> None:
        """What a touch says about every cell, shape (n, n)."""
        self._scale(likelihood)

    def begin_again(self) -> None:
        """What is believed now is the prior of a retry, in which nothing was looked at yet."""
        self._begun = self.weights.copy()
        self._seen[:] = False

    def likeliest_m(self) -> Array:
        """Middle of the cell that holds most of the belief, shape (2,)."""
        cell = np.unravel_index(np.argmax(self.weights), self.weights.shape)
        return np.asarray(self.points_m[cell])

    def mean_m(self) -> Array:
        """Expected place of the hole, shape (2,)."""
        return np.asarray(np.tensordot(self.weights, self.points_m, axes=2))

    def spread_m(self) -> float:
        """Standard deviation of the place, root mean square of both axes."""
        squares = np.sum((self.points_m - self.mean_m()) ** 2, axis=-1)
        return float(np.sqrt(np.sum(self.weights * squares) / 2))

    def _scale(self, factors: Array) -> None:
        scaled = self.weights * factors
        self.weights = scaled / scaled.sum()
