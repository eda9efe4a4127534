"""A plate or a plug with one hole, as heights: where a peg rests, and what carries it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from cellctl.processes.peg_in_hole.plan.task import FitGeometry, SearchTask
from cellctl.processes.peg_in_hole.search.tilted_touch import tilted_dip_m

Array = NDArray[np.float64]
_P99_SIGMAS = 3.035


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What the search does not know."""

    hole_m: Array
    """Axis of the hole in frame A, shape (2,)."""
    slope: Array
    """Slope of the face against frame A, shape (2,)."""
    absent: bool = False
    """There is no hole at all."""

    @classmethod
    def draw(
        cls,
        task: SearchTask,
        rng: np.random.Generator,
        residual_tilt_rad: float = 0.3 * np.pi / 180,
    ) -> "Truth":
        """A hole of the prior that the task states."""
        sigma_m = task.cell.uncertainty_m / _P99_SIGMAS
        return cls(rng.normal(0, sigma_m, 2), rng.normal(0, residual_tilt_rad / 2, 2))


@dataclass(frozen=True, slots=True)
class Surface:
    """Heights about one hole; ``rotation_rad`` (3,) is the tilt of the peg."""

    fit: FitGeometry
    truth: Truth

    def depths_m(self, offsets: Array, ticks: Array, rotation_rad: Array) -> Array:
        """Depths of the tip at rest at each tick, shape (n,); ``offsets`` (n, 2) from the hole."""
        fit = self.fit
        face = ticks @ self.truth.slope
        tilt_rad = float(np.linalg.norm(rotation_rad))
        if tilt_rad == 0:
            free = np.hypot(*offsets.T)
            inside = np.where(free < fit.catch_radius_m, fit.depth_m, 0.0)
            deep = inside if fit.rim_m is None else np.where(free > fit.rim_m, 5e-3, inside)
            deep = (0.0 if self.truth.absent else 1.0) * deep
            # On a tilted face an upright peg stands on its rim.
            ahead_m = fit.rim_radius_m * float(np.hypot(*self.truth.slope))
            return np.asarray(face + np.where(deep == 0.0, -ahead_m, deep))
        leaning = np.array([-rotation_rad[1], rotation_rad[0]]) / tilt_rad
        # The slope of the face along the tilt makes the peg lean more, or less.
        relative_rad = tilt_rad + float(self.truth.slope @ leaning)
        dips = tilted_dip_m(offsets, leaning, fit.peg_radius_m, fit.clearance_m, relative_rad)
        flat = face - fit.peg_radius_m * np.sin(relative_rad)
        return np.asarray(flat + (0.0 if self.truth.absent else 1.0) * dips)

    def carries_not(self, offsets: Array, rotation_rad: Array) -> NDArray[np.bool_]:
        """Where an upright peg has nothing under it, shape (n,)."""
        if np.any(rotation_rad) or self.truth.absent:
            return np.zeros(len(offsets), dtype=bool)
        free, rim_m = np.hypot(*offsets.T), self.fit.rim_m
        lost = free < self.fit.catch_radius_m
        return np.asarray(lost if rim_m is None else lost | (free > rim_m))

    def side_gap_m(self, offset: Array, depth_m: float, direction: Array) -> tuple[float, bool]:
        """Way along a unit vector (2,) to the face of the plug, or to the wall of the hole; and
        whether the peg is inside the hole."""
        fit = self.fit
        along = float(offset @ direction)
        near = float(np.hypot(*offset)) < fit.peg_radius_m
        if near and depth_m > fit.entry_depth_m:
            return fit.clearance_m - along, True
        if fit.rim_m is None:
            return np.inf, False
        root = along**2 - float(offset @ offset) + fit.rim_m**2
        return (np.inf if root < 0 else max(-along - float(np.sqrt(root)), 0.0)), False


def correlated(
    rng: np.random.Generator, count: int, keep: float, sigma: float, begin: Array
) -> Array:
    """Gauss–Markov noise, shape (count, n) for a begin (n,)."""
    drawn = rng.normal(0, sigma * np.sqrt(1 - keep**2), (count, len(begin)))
    state = keep * begin[None, :]
    return np.asarray(lfilter([1.0], [1.0, -keep], drawn, axis=0, zi=state)[0])
