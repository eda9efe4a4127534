"""Maximum-likelihood fit of a rim to the grey values around it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim_light import Light, Surface, surfaces
from cellctl.vision.rim_model import RimPixels, RimShape, borders
from cellctl.vision.rim_noise import scatter_factor, weights_of

_MAX_ITERATIONS = 25
_CONVERGED_PX = 3e-4
_SETTLED_PX = 0.02
_REFRESH = (1, 3, 6)
_MAX_STEP_PX = 0.7
_MAX_DAMPING = 1e4
_BLUR_LIMITS_PX = (0.35, 4.0)
_MAX_WALL_RATIO = 0.2
_RING_LIMITS = (1.02, 1.4)


@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a shape beforehand: mean and standard deviation of ``RimShape.vector``."""

    mean: Array
    sigma: Array
    """Infinite where nothing is known."""


@dataclass(frozen=True, slots=True)
class RimFit:
    """A fitted rim."""

    shape: RimShape
    covariance: Array
    """Shape (3, 3): of centre and radius, in plane units squared."""
    residual_grey: float
    """Standard deviation of the residuals."""
    contrast_grey: float
    """Step from just inside to just outside, mean over the rim."""
    bic: float
    """Bayesian information criterion, to compare models on the same pixels."""
    converged: bool


def fit_rim(pixels: RimPixels, start: RimShape, light: Light, prior: Prior | None = None) -> RimFit:
    """Fit shape and light jointly by robust Gauss-Newton steps from a start within 1–2 px."""
    problem = _Problem(pixels, light, prior or _no_prior(start))
    best = problem.first(start)
    damping, step_px = 1e-6, np.inf
    for iteration in range(_MAX_ITERATIONS):
        trial = problem.solve(_moved(best, damping, problem), best.parts, best.weights)
        if trial.cost > best.cost * (1.0 + 1e-9) and damping < _MAX_DAMPING:
            damping = max(damping, 1e-4) * 10.0
            continue
        change = trial.shape.vector[:3] - best.shape.vector[:3]
        step_px = float(np.abs(change).max() / pixels.unit_px)
        best, damping = trial, damping * 0.2
        if step_px < _CONVERGED_PX:
            break
        if iteration in _REFRESH or step_px < _SETTLED_PX:
            best = problem.refreshed(best)
    return _result(problem, best, converged=step_px < 10 * _CONVERGED_PX)


def rim_cost(pixels: RimPixels, shape: RimShape, light: Light) -> float:
    """Bayesian information criterion of a shape as it stands, with the best light for it."""
    return _bic(_Problem(pixels, light, _no_prior(shape)).first(shape))


@dataclass(frozen=True, slots=True)
class _Solution:
    """Best light for one shape, and what the next step needs."""

    shape: RimShape
    parts: Sequence[Surface]
    weights: Array
    """One over the variance of each pixel, less for outliers."""
    residuals: Array
    design: Array
    """Columns: light, then shape, shape (n, lights + p)."""
    precision: Array
    """Of the priors on light and shape, shape (lights + p,)."""
    pull: Array
    """Prior mean minus present value, shape (lights + p,)."""
    outside: Array
    """Share of each pixel outside the rim."""

    @property
    def lights(self) -> int:
        return self.design.shape[1] - len(self.shape.vector)

    @property
    def cost(self) -> float:
        return float(self.weights @ self.residuals**2 + self.precision @ self.pull**2)

    def normal(self) -> Array:
        weighted = self.design * self.weights[:, None]
        return np.asarray(self.design.T @ weighted + np.diag(self.precision))


@dataclass(frozen=True, slots=True)
class _Problem:
    pixels: RimPixels
    light: Light
    prior: Prior

    def first(self, shape: RimShape) -> _Solution:
        """Solution at the start: equal weights, then weights from its own residuals."""
        parts = surfaces(self.pixels, shape, borders(self.pixels, shape), self.light)
        flat = np.full(len(self.pixels.grey), 1e-2)
        return self.refreshed(self.solve(shape, parts, flat))

    def refreshed(self, solution: _Solution) -> _Solution:
        """The same shape with weights and light terms brought up to date."""
        shape = solution.shape
        parts = surfaces(self.pixels, shape, borders(self.pixels, shape), self.light)
        return self.solve(shape, parts, weights_of(solution.residuals, solution.outside))

    def solve(self, shape: RimShape, parts: Sequence[Surface], weights: Array) -> _Solution:
        """Best light for a shape, by linear least squares, and the derivatives of all pixels.

        A pixel is the sum of its surfaces' greys times the shares that they cover.
        """
        edges = borders(self.pixels, shape)
        columns = np.hstack([part.columns * part.share(edges)[:, None] for part in parts])
        light_precision = np.concatenate([part.sigma_grey for part in parts]) ** -2.0
        weighted = columns * weights[:, None]
        gram = weighted.T @ columns
        gram[np.diag_indices_from(gram)] += light_precision + 1e-9 * np.diag(gram).max()
        levels = np.linalg.solve(gram, weighted.T @ self.pixels.grey)
        by_shape = np.zeros((len(weights), len(shape.vector)))
        ends = np.cumsum([part.columns.shape[1] for part in parts])[:-1]
        for part, amplitudes in zip(parts, np.split(levels, ends), strict=True):
            grey = (part.columns @ amplitudes)[:, None]
            if part.inner is not None:
                by_shape += grey * edges[part.inner].by_shape
            if part.outer is not None:
                by_shape -= grey * edges[part.outer].by_shape
        return _Solution(
            shape,
            parts,
            weights,
            self.pixels.grey - columns @ levels,
            np.hstack([columns, by_shape]),
            np.concatenate([light_precision, self.prior.sigma**-2.0]),
            np.concatenate([-levels, self.prior.mean - shape.vector]),
            edges[0 if shape.ring_ratio is None else 1].outside,
        )


def _no_prior(shape: RimShape) -> Prior:
    return Prior(shape.vector, np.full(len(shape.vector), np.inf))


def _moved(solution: _Solution, damping: float, problem: _Problem) -> RimShape:
    """The shape after a damped Gauss-Newton step, inside what is physically possible."""
    normal = solution.normal()
    size = np.sqrt(np.diag(normal)) + 1e-12
    scaled = normal / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += damping + 1e-10
    gradient = solution.design.T @ (solution.residuals * solution.weights)
    gradient += solution.precision * solution.pull
    step = (np.linalg.solve(scaled, gradient / size) / size)[solution.lights :]
    longest = float(np.abs(step[:3]).max()) / problem.pixels.unit_px
    vector = solution.shape.vector + step * min(1.0, _MAX_STEP_PX / max(longest, 1e-12))
    moved = solution.shape.with_vector(vector)
    wall, ring = moved.wall_ratio, moved.ring_ratio
    return replace(
        moved,
        blur_px=float(np.clip(moved.blur_px, *_BLUR_LIMITS_PX)),
        wall_ratio=None if wall is None else float(np.clip(wall, 0.0, _MAX_WALL_RATIO)),
        ring_ratio=None if ring is None else float(np.clip(ring, *_RING_LIMITS)),
    )


def _bic(solution: _Solution) -> float:
    residuals = np.abs(solution.residuals)
    count = len(residuals)
    limit = 4.0 * max(float(np.median(residuals)), 0.2)
    mean_square = float(np.mean(np.minimum(residuals, limit) ** 2))
    free = int(np.count_nonzero(solution.precision == 0.0))
    return count * float(np.log(mean_square)) + free * float(np.log(count))


def _result(problem: _Problem, solution: _Solution, *, converged: bool) -> RimFit:
    normal = solution.normal()
    size = np.sqrt(np.diag(normal)) + 1e-12
    scaled = normal / np.outer(size, size)
    inverse = np.linalg.pinv(scaled, rcond=1e-12, hermitian=True) / np.outer(size, size)
    geometry = slice(solution.lights, solution.lights + 3)
    influence = (solution.design @ inverse[:, geometry]) * solution.weights[:, None]
    offset = problem.pixels.points - solution.shape.centre
    factor = scatter_factor(
        influence[:, :2] * solution.residuals[:, None],
        np.arctan2(offset[:, 1], offset[:, 0]),
        inverse[geometry, geometry][:2, :2],
    )
    wide = np.eye(3)
    wide[:2, :2] = factor
    outside = solution.outside
    grey = problem.pixels.grey - solution.residuals
    return RimFit(
        shape=solution.shape,
        covariance=wide @ inverse[geometry, geometry] @ wide.T,
        residual_grey=float(np.sqrt(np.mean(solution.residuals**2))),
        contrast_grey=float(
            np.average(grey, weights=outside + 1e-9)
            - np.average(grey, weights=1.0 - outside + 1e-9)
        ),
        bic=_bic(solution),
        converged=converged,
    )
