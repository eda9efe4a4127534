"""Maximum-likelihood fit of a rim to the grey values around it, in one image or in both."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimPixels, RimShape, outside_walls
from cellctl.vision.rim.noise import arc_covariance, texture_covariance, widened
from cellctl.vision.rim.problem import Problem, RimView, Solution, first, refreshed
from cellctl.vision.rim.robust import median
from cellctl.vision.rim.solve import minimise

_WALL_MODEL_PX, _CONE_MODEL_PX, _RING_MODEL_PX = 0.02, 0.027, 0.06
"""Error of a centre when the light at the rim varies by as much as the rim's contrast."""

_ROUGH_PX = 0.03


@dataclass(frozen=True, slots=True)
class RimFit:
    """A fitted rim."""

    shapes: tuple[RimShape, ...]
    """In each image."""
    covariance: Array
    """Of centre and radius, in plane units squared: (x, y) of every image, then the radius."""
    residual_grey: float
    """Standard deviation of the residuals."""
    contrast_grey: float
    """Step from inside to outside."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A model at its best, before anything is said about its uncertainty."""

    problem: Problem
    solution: Solution
    converged: bool

    @property
    def shapes(self) -> tuple[RimShape, ...]:
        """In each image."""
        return tuple(view.shape(self.solution.vector) for view in self.problem.views)

    def bic(self) -> float:
        """Bayesian information criterion, to compare models on the same pixels."""
        residuals = np.abs(self.solution.residuals)
        count = len(residuals)
        limit = 4.0 * max(median(residuals), 0.2)
        mean_square = float(np.mean(np.minimum(residuals, limit) ** 2))
        free = int(np.count_nonzero(self.solution.precision == 0.0))
        return count * float(np.log(mean_square)) + free * float(np.log(count))


def fit_rim(pixels: RimPixels, start: RimShape, light: Light, across_lay: Array | None) -> Fitted:
    """Fit one image from a start within 1–2 px."""
    problem = _alone(pixels, start, light, across_lay)
    return Fitted(problem, *minimise(problem, first(problem, start.vector)))


def rough_rim(pixels: RimPixels, start: RimShape, light: Light, across_lay: Array | None) -> Fitted:
    """A quick fit to a few hundredths of a pixel, to be ``finished``."""
    problem = _alone(pixels, start, light, across_lay)
    return _rough(problem, start.vector)


def finished(rough: Fitted) -> Fitted:
    """A rough fit brought to its end."""
    start = refreshed(rough.problem, rough.solution)
    return Fitted(rough.problem, *minimise(rough.problem, start, weighing_rounds=0))


def likely_wall(bare: Fitted, ratios: Sequence[float]) -> tuple[float, float]:
    """The wall ratio that would explain most of the misfit of a rim without a wall, and its gain.

    A score test: how far the weighted squares would fall if a wall of unknown, even grey were
    seen, with shape and light free to follow to first order.
    """
    solution, shape = bare.solution, bare.shapes[0]
    pixels = bare.problem.views[0].pixels
    seen = outside_walls(pixels, shape, ratios) - solution.outside
    weighted = solution.noise.weigh(seen)
    shared = weighted @ solution.design.T
    normal = np.linalg.inv(solution.normal() + 1e-9 * np.eye(len(solution.design)))
    size = (weighted * seen).sum(axis=1) - ((shared @ normal) * shared).sum(axis=1)
    gains = np.where(size > 1e-6, (weighted @ solution.residuals) ** 2 / np.maximum(size, 1e-6), 0)
    best = int(np.argmax(gains))
    return ratios[best], float(gains[best])


@dataclass(frozen=True, slots=True)
class RingPrior:
    """What is known of a rim with a ring before it is seen."""

    radius_sigma: float
    """Relative."""
    ring_ratio: float
    ring_sigma: float
    blur_sigma_px: float


def rough_rim_pair(
    pixels: tuple[RimPixels, RimPixels],
    starts: tuple[RimShape, RimShape],
    light: Light,
    prior: RingPrior,
    across_lay: Array | None,
) -> Fitted:
    """A rough fit, to be ``finished``, of a rim with a ring in both images at once.

    A ring two pixels wide whose grey is not known is easily taken for a shift of the rim. Both
    cameras see the same ring in the same light: what they share is estimated once, so that the
    difference between the images, hence the depth, does not suffer from it.
    Joint parameters: x, y left; x, y right; radius left; blur left and right; ring ratio.
    """
    left, right = starts
    selections = np.zeros((2, 5, 8))
    selections[0, [0, 1, 2, 3, 4], [0, 1, 4, 5, 7]] = 1.0
    selections[1, [0, 1, 2, 3, 4], [2, 3, 4, 6, 7]] = [1, 1, right.radius / left.radius, 1, 1]
    mean = np.array(
        [*left.centre, *right.centre, left.radius, left.blur_px, right.blur_px, prior.ring_ratio]
    )
    sigma = np.full(8, np.inf)
    sigma[4] = prior.radius_sigma * left.radius
    sigma[5:] = prior.blur_sigma_px, prior.blur_sigma_px, prior.ring_sigma
    outer = [float(np.percentile(part.grey, 90)) for part in pixels]
    views = tuple(
        RimView(part, shape, selection, grey / outer[0])
        for part, shape, selection, grey in zip(pixels, starts, selections, outer, strict=True)
    )
    problem = Problem(views, light, mean, sigma, across_lay)
    return _rough(problem, mean)


def _rough(problem: Problem, start: Array) -> Fitted:
    begun = first(problem, start)
    return Fitted(problem, *minimise(problem, begun, tolerance_px=_ROUGH_PX, weighing_rounds=1))


def _alone(pixels: RimPixels, shape: RimShape, light: Light, across_lay: Array | None) -> Problem:
    size = len(shape.vector)
    view = RimView(pixels, shape, np.eye(size))
    sigma = np.full(size, np.inf)
    if shape.wall_ratio is not None:
        sigma[4] = (
            4.0 * shape.wall_ratio
        )  # Where the lower edge is out of sight, nothing else holds it.
    return Problem((view,), light, shape.vector, sigma, across_lay)


def rated(fitted: Fitted) -> RimFit:
    """The fit with its uncertainty: pixel noise, texture, and what the model leaves unexplained."""
    problem, solution = fitted.problem, fitted.solution
    geometry = range(2 * len(problem.views) + 1)
    rows = [solution.lights + index for index in geometry]
    everything = solution.covariance()
    covariance = everything[np.ix_(rows, rows)]
    influence = everything[rows] @ solution.noise.weigh(solution.design)
    unexplained = solution.noise.own(solution.residuals)
    scores = everything[rows] @ solution.design * solution.noise.weights * unexplained
    seen, start = np.zeros_like(covariance), 0
    offsets = []
    for view in problem.views:
        part = slice(start, start + len(view.pixels.grey))
        start = part.stop
        offsets.append(view.pixels.points - view.shape(solution.vector).centre[:, None])
        seen += texture_covariance(
            view.pixels.place,
            unexplained[part],
            solution.outside[part],
            influence[:, part],
        )
    x, y = np.concatenate(offsets, axis=1)
    arcs = arc_covariance(scores, np.arctan2(y, x))
    covariance = widened(widened(covariance, arcs), seen)
    outside = solution.outside
    grey = np.concatenate([view.pixels.grey for view in problem.views]) - solution.residuals
    contrast = float(np.average(grey, weights=outside + 1e-9)) - float(
        np.average(grey, weights=1.0 - outside + 1e-9)
    )
    covariance += _model_covariance(problem, grey, outside, contrast, len(geometry))
    return RimFit(
        shapes=fitted.shapes,
        covariance=covariance,
        residual_grey=float(np.sqrt(np.mean(unexplained**2))),
        contrast_grey=contrast,
    )


def _model_covariance(
    problem: Problem, grey: Array, outside: Array, contrast: float, size: int
) -> Array:
    """What a few smooth terms leave unexplained grows with how uneven the light at a rim is."""
    sides = (grey[outside > 0.95], grey[outside < 0.05])
    variances = [float(np.var(side)) if len(side) else 0.0 for side in sides]
    uneven = float(np.sqrt(sum(variances))) / max(abs(contrast), 1.0)
    share_px = _CONE_MODEL_PX if problem.light.cone else _WALL_MODEL_PX
    if problem.views[0].model.ring_ratio is not None:
        share_px = _RING_MODEL_PX
    sigma = share_px * uneven * problem.views[0].pixels.unit_px
    return np.diag([*[sigma**2] * (size - 1), 0.0])
