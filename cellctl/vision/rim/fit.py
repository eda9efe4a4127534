"""Maximum-likelihood fit of a rim to the grey values around it, in one image or in both."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimPixels, RimShape
from cellctl.vision.rim.noise import arc_covariance, texture_covariance, widened
from cellctl.vision.rim.problem import Problem, RimView, Solution, first, refreshed
from cellctl.vision.rim.robust import median
from cellctl.vision.rim.solve import minimise

_WALL_MODEL_PX, _CONE_MODEL_PX, _RING_MODEL_PX = 0.02, 0.027, 0.06
"""Error of a centre when the light at the rim varies by as much as the rim's contrast."""

_ROUGH_PX = 0.03
_RADIUS_SIGMA = 0.005
"""Relative: it counts only where little of a rim stands out."""


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


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a rim in one image before it is fitted."""

    radius: float
    """Nominal, plane units."""
    across_lay: Array | None
    """Unit vector across the lay of the face, if it has one."""


def fit_rim(pixels: RimPixels, start: RimShape, light: Light, known: Known) -> Fitted:
    """Fit one image from a start within 1–2 px."""
    problem = _alone(pixels, start, light, known)
    return Fitted(problem, *minimise(problem, first(problem, start.vector)))


def rough_rim(pixels: RimPixels, start: RimShape, light: Light, known: Known) -> Fitted:
    """A quick fit to a few hundredths of a pixel, to be ``finished``."""
    problem = _alone(pixels, start, light, known)
    return _rough(problem, start.vector)


def finished(rough: Fitted) -> Fitted:
    """A rough fit brought to its end."""
    start = refreshed(rough.problem, rough.solution)
    return Fitted(rough.problem, *minimise(rough.problem, start, weighing_rounds=0))


@dataclass(frozen=True, slots=True)
class PairPrior:
    """What is known of the blur and of a ring or wall before they are seen, standard deviations."""

    blur_sigma_px: float
    extra_sigma: float
    """Of the ring ratio or of the wall ratio."""


def rough_rim_pair(
    pixels: tuple[RimPixels, RimPixels],
    starts: tuple[RimShape, RimShape],
    light: Light,
    prior: PairPrior,
    across_lay: Array | None,
) -> Fitted:
    """A rough fit, to be ``finished``, of a rim in both images at once, plain or with ring or wall.

    A ring two pixels wide whose grey is not known is easily taken for a shift of the rim. Both
    cameras see the same ring in the same light: what they share is estimated once, so that the
    difference between the images, hence the depth, does not suffer from it.
    Joint parameters: x, y left; x, y right; radius left; blur left and right; ratio, if any.
    """
    left, right = starts
    ratio = [value for value in (left.wall_ratio, left.ring_ratio) if value is not None]
    size, nearer = 4 + len(ratio), right.radius / left.radius
    selections = np.zeros((2, size, 7 + len(ratio)))
    selections[0, range(size), [0, 1, 4, 5, 7][:size]] = 1.0
    selections[1, range(size), [2, 3, 4, 6, 7][:size]] = [1.0, 1.0, nearer, 1.0, 1.0][:size]
    if left.wall_ratio is not None:
        selections[1, 4, 7] = nearer
    mean = np.array([*left.centre, *right.centre, left.radius, left.blur_px, right.blur_px, *ratio])
    sigma = np.full(len(mean), np.inf)
    sigma[4] = _RADIUS_SIGMA * left.radius
    sigma[5:7] = prior.blur_sigma_px
    sigma[7:] = prior.extra_sigma
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


def _alone(pixels: RimPixels, shape: RimShape, light: Light, known: Known) -> Problem:
    size = len(shape.vector)
    view = RimView(pixels, shape, np.eye(size))
    mean, sigma = shape.vector, np.full(size, np.inf)
    mean[2], sigma[2] = known.radius, _RADIUS_SIGMA * known.radius
    if shape.wall_ratio is not None:
        # Where the lower edge is out of sight, nothing else holds it.
        sigma[4] = 4.0 * shape.wall_ratio
    return Problem((view,), light, mean, sigma, known.across_lay)


def rated(fitted: Fitted) -> RimFit:
    """The fit with its uncertainty: pixel noise, texture, and what the model leaves unexplained."""
    problem, solution = fitted.problem, fitted.solution
    geometry = range(2 * len(problem.views) + 1)
    rows = [solution.lights + index for index in geometry]
    everything = solution.covariance
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
