"""The uncertainty of a fitted rim: the noise of its pixels and what the model leaves unexplained.

The inverse of the normal matrix would be the covariance if all errors of the pixels were
independent and the model were complete. Neither holds on machined parts, so what the residuals show
of the contrary is added.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.arcs import ARCS, MODEL_PX, arc_of
from cellctl.vision.rim.noise import BRIGHT, DARK
from cellctl.vision.rim.problem import RimProblem, by_radius
from cellctl.vision.rim.shape import RimShape
from cellctl.vision.rim.solver import RimFit

_WALL_MODEL_PX, _CONE_MODEL_PX, _RING_MODEL_PX = 0.02, 0.027, 0.06
"""Error of a centre when the light at the rim varies by as much as the rim's contrast."""
_REACH = 6
"""Number of arcs over which errors may hang together."""
_LOST = 1.4
"""Factor that makes up for what the fit takes out of these sums: it brings their total to zero."""
_SHRINK = 0.3
"""Share of the mean over all directions in the estimate of each."""
MOST_LEFT_OUT = 0.45
"""Share of a rim that may leave its fit: the edges of the rest must be a rim."""
CHANCE = 2.1
"""Sums over a few arcs reach this multiple of what independent errors give by chance alone. Only
what exceeds it widens the covariance."""

_STEPS = np.abs(np.subtract.outer(np.arange(ARCS), np.arange(ARCS)))
# Bartlett's triangle, as Newey and West have it. It is a box correlated with itself, so that no
# choice of sums can give a negative variance.
_KERNEL: Array = np.maximum(1.0 - np.minimum(_STEPS, ARCS - _STEPS) / _REACH, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class RatedFit:
    """A fitted rim with its uncertainty."""

    fit: RimFit
    covariance: Array
    """Covariance of (x, y) of every image, then of the radius, in plane units squared."""
    contrast_grey: float
    """Step from inside to outside."""
    misfit: float
    """Squares of what the residuals sum to over arcs, over what independent errors give: about 1
    where the model is complete."""

    @property
    def shapes(self) -> tuple[RimShape, ...]:
        """The geometry of the rim in each image."""
        return self.fit.shapes


def with_covariance(fit: RimFit, spread: Array) -> RatedFit:
    """Rate a fit.

    ``spread`` is the covariance of centre and radius, or of the centre alone, that comes from other
    models which explain the pixels nearly as well; plane units squared.
    """
    problem, solution = fit.problem, fit.solution
    independent, seen = _independent(fit), _seen(fit)
    covariance = _widened(independent, seen)
    outside = solution.outside
    grey = np.concatenate([view.pixels.grey for view in problem.views]) - solution.residuals
    contrast = float(np.average(grey, weights=outside + 1e-9)) - float(
        np.average(grey, weights=1.0 - outside + 1e-9)
    )
    # These errors leave no trace in the residuals of one rim, so a share of the visible unevenness
    # stands for them.
    covariance += _model_covariance(problem, grey, outside, contrast)
    covariance[: len(spread), : len(spread)] += spread
    misfit = _ratio(fit, seen, independent)
    if problem.arcs_may_leave and misfit > CHANCE:
        # Arcs have left the fit and the rest is no circle either: what it shows is the part that
        # the fit could not take up, and the same error has moved the centre, too.
        covariance = covariance * misfit
    covariance = covariance * _doubt_of_rest(solution.noise.share_left_out)
    return RatedFit(fit, covariance, contrast, misfit)


def _doubt_of_rest(left_out: float) -> float:
    """Factor of the covariance by the share of a rim that has left its fit.

    Which arcs leave is told by the others, and by ever fewer of them: their verdict is worth what
    they are more than those that are off, and nothing at a half.
    """
    share = min(left_out, MOST_LEFT_OUT)
    return 1.0 + (share / (1.0 - 2.0 * share)) ** 2


def misfit_beyond_model(fit: RimFit) -> float:
    """The misfit over what independent errors and a small error of the model itself explain.

    In images with hardly any noise the model is the larger error of the two.
    """
    problem, solution = fit.problem, fit.solution
    rows = slice(solution.lights, solution.lights + problem.geometry)
    by_grey = solution.noise.weigh(solution.covariance[rows] @ solution.design)
    moved = by_grey * by_radius(problem, solution) * MODEL_PX
    sums = _sums_over_arcs(moved, problem.azimuths(solution.vector))
    of_model = sums @ sums.T
    return _ratio(fit, _seen(fit), _independent(fit) + of_model)


def _ratio(fit: RimFit, seen: Array, expected: Array) -> float:
    """Mean variance of the centres that is seen, over the expected one in each direction."""
    centre = slice(2 * len(fit.problem.views))
    inverse = np.linalg.inv(expected[centre, centre])
    return float(np.trace(inverse @ seen[centre, centre])) / len(inverse)


def _independent(fit: RimFit) -> Array:
    """Covariance of centres and radius if all errors of the pixels were independent."""
    rows = slice(fit.solution.lights, fit.solution.lights + fit.problem.geometry)
    return np.asarray(fit.solution.covariance[rows, rows])


def _seen(fit: RimFit) -> Array:
    """Covariance of centres and radius that the residuals show, summed over arcs."""
    solution = fit.solution
    rows = slice(solution.lights, solution.lights + fit.problem.geometry)
    unexplained = solution.noise.own(solution.residuals)
    # To first order this is how far each pixel's residual alone moves the centre.
    scores = solution.covariance[rows] @ solution.design * solution.noise.weights * unexplained
    # Both images of a joint fit share the arcs: what disturbs one side of a rim disturbs it in
    # both.
    return arc_covariance(scores, fit.problem.azimuths(solution.vector))


def _model_covariance(problem: RimProblem, grey: Array, outside: Array, contrast: float) -> Array:
    """Covariance of the error of the light model, which grows with how uneven the light is."""
    sides = (grey[outside > BRIGHT], grey[outside < DARK])
    variances = [float(np.var(side)) if len(side) else 0.0 for side in sides]
    uneven = float(np.sqrt(sum(variances))) / max(abs(contrast), 1.0)
    share_px = _CONE_MODEL_PX if problem.light.cone else _WALL_MODEL_PX
    if problem.views[0].model.ring_ratio is not None:
        share_px = _RING_MODEL_PX
    sigma = share_px * uneven * problem.unit_px
    # The radius stays as it is: such errors shift a rim, they hardly change its size.
    return np.diag([*[sigma**2] * (2 * len(problem.views)), 0.0])


def arc_covariance(scores: Array, azimuth: Array) -> Array:
    """Covariance of the centre from what its scores sum to over arcs, shape (k, k).

    ``scores`` (k, n) is what each pixel's residual contributes to the centre. Errors of scratches
    and of an imperfect model of the light are alike in neighbouring pixels: this is the estimator
    of Newey and West for correlated errors, on the circle.
    """
    sums = _sums_over_arcs(scores, azimuth)
    return np.asarray(_LOST * sums @ _KERNEL @ sums.T)


def _sums_over_arcs(scores: Array, azimuth: Array) -> Array:
    """Sums of scores (k, n) over the pixels of each arc, shape (k, 36)."""
    arc = arc_of(azimuth)
    return np.stack([np.bincount(arc, row, minlength=ARCS) for row in scores])


def _widened(covariance: Array, seen: Array) -> Array:
    """The covariance, enlarged where ``seen`` exceeds it by more than chance."""
    root = np.linalg.cholesky(covariance)
    inverse = np.linalg.inv(root)
    whitened = inverse @ seen @ inverse.T
    # Few sums make a ragged estimate: it is drawn towards its mean over all directions.
    even = np.trace(whitened) / len(seen) * np.eye(len(seen))
    values, vectors = np.linalg.eigh((1.0 - _SHRINK) * whitened + _SHRINK * even)
    wide = root @ vectors
    return np.asarray((wide * np.where(values > CHANCE, values, 1.0)) @ wide.T)
