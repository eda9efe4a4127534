"""Maximum-likelihood fit of a rim to the grey values around it."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim_model import RimImage, RimPixels, RimShape, rim_image

_MAX_ITERATIONS = 25
_CONVERGED_PX = 2e-4
_BLUR_LIMITS_PX = (0.35, 4.0)
_MAX_STEP_PX = 0.7
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


@dataclass(frozen=True, slots=True)
class Light:
    """Which grey-value terms are free beside the mean levels and an even gradient."""

    cone: bool = False
    """Outside the rim lies the cone of a countersink, whose grey varies with the azimuth."""


def fit_rim(pixels: RimPixels, start: RimShape, light: Light) -> RimFit:
    """Fit shape and light jointly by robust Gauss-Newton steps from a start within 1–2 px."""
    px = _plane_units_per_px(pixels)
    shape = start
    weights = np.ones(len(pixels.grey))
    step_px = np.inf
    cost = np.inf
    damping = 1e-6
    iteration = 0
    solution = _solve(pixels, shape, light, weights, damping, px)
    for iteration in range(_MAX_ITERATIONS):  # noqa: B007
        candidate = _moved(shape, solution.step, px)
        trial = _solve(pixels, candidate, light, weights, damping, px)
        if trial.cost > solution.cost * (1.0 + 1e-9) and damping < 1e3:
            damping = max(damping, 1e-4) * 10.0
            solution = _solve(pixels, shape, light, weights, damping, px)
            continue
        step_px = float(np.abs(candidate.vector[:3] - shape.vector[:3]).max() / px)
        shape, damping = candidate, damping * 0.2
        weights = _huber_weights(trial.residuals)
        solution = _solve(pixels, shape, light, weights, damping, px)
        if step_px < _CONVERGED_PX:
            break
    del cost
    return _result(pixels, shape, solution, weights, converged=step_px < 10 * _CONVERGED_PX)


@dataclass(frozen=True, slots=True)
class _Solution:
    step: Array
    residuals: Array
    cost: float
    normal: Array
    """Normal matrix over light and shape, without damping."""
    lights: int
    contrast_grey: float


def _solve(
    pixels: RimPixels, shape: RimShape, light: Light, weights: Array, damping: float, px: float
) -> _Solution:
    """Best light for a shape, and the Gauss-Newton step of the shape from there."""
    image = rim_image(pixels, shape)
    design, outside, wall = _light_columns(pixels, shape, image, light)
    root = np.sqrt(weights)
    weighted = design * root[:, None]
    gram = weighted.T @ weighted
    gram[np.diag_indices_from(gram)] += 1e-6 * (1.0 + np.diag(gram).max() * 1e-6)
    levels = np.linalg.solve(gram, weighted.T @ (pixels.grey * root))
    residuals = pixels.grey - design @ levels
    plate_grey = outside @ levels[: outside.shape[1]]
    dark_grey = levels[-1]
    if wall is None:
        by_shape = (plate_grey - dark_grey)[:, None] * image.outside_by_shape
    else:
        wall_grey = wall @ levels[outside.shape[1] : -1]
        by_shape = (plate_grey - wall_grey)[:, None] * image.outside_by_shape
        by_shape += (wall_grey - dark_grey)[:, None] * image.not_dark_by_shape
    units = np.array([px, px, px, 1.0, 1.0][: by_shape.shape[1]])
    if by_shape.shape[1] > 4:
        units[4] = px / max(float(np.linalg.norm(shape.centre)), shape.radius)
    full = np.hstack([weighted, by_shape * (units * root[:, None])])
    normal = full.T @ full
    damped = normal.copy()
    damped[np.diag_indices_from(damped)] *= 1.0 + damping
    damped[np.diag_indices_from(damped)] += 1e-9 * np.trace(normal) / len(normal)
    delta = np.linalg.solve(damped, full.T @ (residuals * root))
    lights = design.shape[1]
    scale = np.concatenate([np.ones(lights), units])
    return _Solution(
        delta[lights:] * units,
        residuals,
        float(weights @ residuals**2),
        normal / np.outer(scale, scale),
        lights,
        float(np.mean(plate_grey)) - float(dark_grey),
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


def _moved(shape: RimShape, step: Array, px: float) -> RimShape:
    """The shape after a step, kept inside what is physically possible."""
    limited = np.array(step)
    longest = float(np.abs(step[:3]).max()) / px
    if longest > _MAX_STEP_PX:
        limited *= _MAX_STEP_PX / longest
    vector = shape.vector + limited
    vector[3] = np.clip(vector[3], *_BLUR_LIMITS_PX)
    if len(vector) > 4:
        vector[4] = np.clip(vector[4], 0.0, 0.2)
    return RimShape.from_vector(vector)


def _huber_weights(residuals: Array) -> Array:
    limit = _HUBER * max(_robust_sigma(residuals), _MIN_SCALE_GREY)
    return np.asarray(np.minimum(1.0, limit / np.maximum(np.abs(residuals), 1e-12)))


def _robust_sigma(residuals: Array) -> float:
    return 1.4826 * float(np.median(np.abs(residuals - np.median(residuals))))


def _plane_units_per_px(pixels: RimPixels) -> float:
    return float(np.sqrt(np.abs(np.mean(np.linalg.det(pixels.jacobian)))))


def _result(
    pixels: RimPixels, shape: RimShape, solution: _Solution, weights: Array, *, converged: bool
) -> RimFit:
    residuals, count = solution.residuals, len(pixels.grey)
    sigma = max(_robust_sigma(residuals), _MIN_SCALE_GREY)
    free = solution.lights + len(shape.vector)
    variance = float(weights @ residuals**2) / max(float(weights.sum()) - free, 1.0)
    size = np.sqrt(np.diag(solution.normal)) + 1e-12
    scaled = solution.normal / np.outer(size, size)
    inverse = np.linalg.pinv(scaled, rcond=1e-12, hermitian=True) / np.outer(size, size)
    geometry = slice(solution.lights, solution.lights + 3)
    return RimFit(
        shape=shape,
        covariance=inverse[geometry, geometry] * variance,
        residual_grey=sigma,
        contrast_grey=solution.contrast_grey,
        explained=float(np.mean(np.abs(residuals) < 3.0 * sigma)),
        bic=count * float(np.log(np.mean(weights * residuals**2))) + free * float(np.log(count)),
        converged=converged,
    )
