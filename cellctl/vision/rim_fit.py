"""Maximum-likelihood fit of a rim to the grey values around it."""

from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim_model import RimImage, RimPixels, RimShape, rim_image

_MAX_ITERATIONS = 25
_CONVERGED_PX = 2e-4
_BLUR_LIMITS_PX = (0.35, 4.0)
_MAX_STEP_PX = 0.7
_MAX_DAMPING = 1e4
_MAX_WALL_RATIO = 0.2
_REWEIGHT = (1, 3, 6)
_SETTLED_PX = 0.01
_HUBER = 2.5
_MIN_SCALE_GREY = 0.3
"""Rounding to 8 bit alone leaves this much."""


@dataclass(frozen=True, slots=True)
class RimFit:
    """A fitted rim."""

    shape: RimShape
    covariance: Array
    """Shape (3, 3): of centre and radius, in plane units squared."""
    residual_grey: float
    """Robust standard deviation of the residuals."""
    contrast_grey: float
    """Mean step from inside to outside."""
    explained: float
    """Share of pixels whose residual is within three standard deviations."""
    bic: float
    """Bayesian information criterion, to compare models on the same pixels."""
    converged: bool
    pixels: int


@dataclass(frozen=True, slots=True)
class Light:
    """Which grey-value terms are free beside the mean levels and an even gradient."""

    cone: bool = False
    """Outside the rim lies the cone of a countersink, whose grey varies with the azimuth."""


def fit_rim(pixels: RimPixels, start: RimShape, light: Light) -> RimFit:
    """Fit shape and light jointly by robust Gauss-Newton steps from a start within 1–2 px."""
    px = _plane_units_per_px(pixels)
    weights = np.ones(len(pixels.grey))
    best = _solve(pixels, start, light, weights)
    damping, step_px = 1e-6, np.inf
    for iteration in range(_MAX_ITERATIONS):
        trial = _solve(pixels, _moved(best, damping, px), light, weights)
        if trial.cost > best.cost * (1.0 + 1e-9) and damping < _MAX_DAMPING:
            damping = max(damping, 1e-4) * 10.0
            continue
        step_px = float(np.abs(trial.shape.vector[:3] - best.shape.vector[:3]).max() / px)
        best, damping = trial, damping * 0.2
        if step_px < _CONVERGED_PX:
            break
        if iteration in _REWEIGHT or step_px < _SETTLED_PX:
            weights = _huber_weights(best.residuals)
            best = best.reweighted(weights)
    return _result(pixels, best, converged=step_px < 10 * _CONVERGED_PX)


def rim_cost(pixels: RimPixels, shape: RimShape, light: Light) -> float:
    """Bayesian information criterion of a shape as it stands, with the best light for it."""
    solution = _solve(pixels, shape, light, np.ones(len(pixels.grey)))
    return _bic(solution)


@dataclass(frozen=True, slots=True)
class _Solution:
    """Best light for one shape, and what the next step needs."""

    shape: RimShape
    weights: Array
    residuals: Array
    design: Array
    """Columns: light, then shape, shape (n, lights + p)."""
    lights: int
    contrast_grey: float

    @property
    def cost(self) -> float:
        return float(self.weights @ self.residuals**2)

    def reweighted(self, weights: Array) -> "_Solution":
        return replace(self, weights=weights)

    def normal(self) -> Array:
        return np.asarray(self.design.T @ (self.design * self.weights[:, None]))


def _solve(pixels: RimPixels, shape: RimShape, light: Light, weights: Array) -> _Solution:
    """Best light for a shape, by linear least squares, and the derivatives by light and shape."""
    image = rim_image(pixels, shape)
    columns, outside, wall = _light_columns(pixels, shape, image, light)
    weighted = columns * weights[:, None]
    gram = weighted.T @ columns
    gram[np.diag_indices_from(gram)] += 1e-6 + 1e-9 * np.diag(gram).max()
    levels = np.linalg.solve(gram, weighted.T @ pixels.grey)
    plate_grey = outside @ levels[: outside.shape[1]]
    dark_grey = float(levels[-1])
    if wall is None:
        by_shape = (plate_grey - dark_grey)[:, None] * image.outside_by_shape
    else:
        wall_grey = wall @ levels[outside.shape[1] : -1]
        by_shape = (plate_grey - wall_grey)[:, None] * image.outside_by_shape
        by_shape += (wall_grey - dark_grey)[:, None] * image.not_dark_by_shape
    return _Solution(
        shape,
        weights,
        pixels.grey - columns @ levels,
        np.hstack([columns, by_shape]),
        columns.shape[1],
        float(np.mean(plate_grey)) - dark_grey,
    )


def _light_columns(
    pixels: RimPixels, shape: RimShape, image: RimImage, light: Light
) -> tuple[Array, Array, Array | None]:
    """Columns of the linear model, and the polynomials outside and on the wall."""
    x, y = ((pixels.points - shape.centre) / shape.radius).T
    radius = np.maximum(np.hypot(x, y), 1e-6)
    cos, sin, above, one = x / radius, y / radius, radius - 1.0, np.ones_like(x)
    outside = np.column_stack([one, x, y])
    if light.cone:
        double = [cos * cos - sin * sin, 2.0 * sin * cos]
        outside = np.column_stack([one, cos, sin, *double, above, above * cos, above * sin])
    dark = (1.0 - image.not_dark)[:, None]
    plate = outside * image.outside[:, None]
    if shape.wall_ratio is None:
        return np.hstack([plate, dark]), outside, None
    wall = np.column_stack([one, cos, sin, above])
    seen = (image.not_dark - image.outside)[:, None]
    return np.hstack([plate, wall * seen, dark]), outside, wall


def _moved(solution: _Solution, damping: float, px: float) -> RimShape:
    """The shape after a damped Gauss-Newton step, inside what is physically possible."""
    normal = solution.normal()
    size = np.sqrt(np.diag(normal)) + 1e-12
    scaled = normal / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += damping + 1e-10
    gradient = solution.design.T @ (solution.residuals * solution.weights)
    step = (np.linalg.solve(scaled, gradient / size) / size)[solution.lights :]
    longest = float(np.abs(step[:3]).max()) / px
    vector = solution.shape.vector + step * min(1.0, _MAX_STEP_PX / max(longest, 1e-12))
    vector[3] = np.clip(vector[3], *_BLUR_LIMITS_PX)
    if len(vector) > 4:
        vector[4] = np.clip(vector[4], 0.0, _MAX_WALL_RATIO)
    return RimShape.from_vector(vector)


def _huber_weights(residuals: Array) -> Array:
    limit = _HUBER * max(_robust_sigma(residuals), _MIN_SCALE_GREY)
    return np.asarray(np.minimum(1.0, limit / np.maximum(np.abs(residuals), 1e-12)))


def _robust_sigma(residuals: Array) -> float:
    return 1.4826 * float(np.median(np.abs(residuals - np.median(residuals))))


def _plane_units_per_px(pixels: RimPixels) -> float:
    return float(np.sqrt(np.abs(np.mean(np.linalg.det(pixels.jacobian)))))


def _bic(solution: _Solution) -> float:
    count = len(solution.residuals)
    mean_square = solution.cost / float(solution.weights.sum())
    free = solution.design.shape[1]
    return count * float(np.log(max(mean_square, 1e-6))) + free * float(np.log(count))


def _result(pixels: RimPixels, solution: _Solution, *, converged: bool) -> RimFit:
    sigma = max(_robust_sigma(solution.residuals), _MIN_SCALE_GREY)
    freedom = float(solution.weights.sum()) - solution.design.shape[1]
    variance = solution.cost / max(freedom, 1.0)
    normal = solution.normal()
    size = np.sqrt(np.diag(normal)) + 1e-12
    scaled = normal / np.outer(size, size)
    inverse = np.linalg.pinv(scaled, rcond=1e-12, hermitian=True) / np.outer(size, size)
    geometry = slice(solution.lights, solution.lights + 3)
    return RimFit(
        shape=solution.shape,
        covariance=inverse[geometry, geometry] * variance,
        residual_grey=sigma,
        contrast_grey=solution.contrast_grey,
        explained=float(np.mean(np.abs(solution.residuals) < 3.0 * sigma)),
        bic=_bic(solution),
        converged=converged,
        pixels=len(pixels.grey),
    )
