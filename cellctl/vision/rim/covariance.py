"""The uncertainty of a fitted rim: the noise of its pixels and what the model leaves unexplained.

The inverse of the normal matrix would be the covariance if all errors of the pixels were
independent and the model were complete. Neither holds on machined parts, so what the residuals show
of the contrary is added.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.noise import BRIGHT, DARK
from cellctl.vision.rim.problem import RimProblem
from cellctl.vision.rim.shape import RimShape
from cellctl.vision.rim.solver import RimFit

_WALL_MODEL_PX, _CONE_MODEL_PX, _RING_MODEL_PX = 0.02, 0.027, 0.06
"""Error of a centre when the light at the rim varies by as much as the rim's contrast."""
_BINS, _REACH = 36, 6
"""Sectors of azimuth, and over how many of them errors may hang together."""
_LOST = 1.4
"""Factor that makes up for what the fit takes out of these sums: it brings their total to zero."""
_SHRINK = 0.3
"""Share of the mean over all directions in the estimate of each."""
CHANCE = 2.1
"""Sums over a few arcs reach this multiple of what independent errors give by chance alone. Only
what exceeds it widens the covariance."""

_STEPS = np.abs(np.subtract.outer(np.arange(_BINS), np.arange(_BINS)))
# Bartlett's triangle, as Newey and West have it. It is a box correlated with itself, so that no
# choice of sums can give a negative variance.
_KERNEL: Array = np.maximum(1.0 - np.minimum(_STEPS, _BINS - _STEPS) / _REACH, 0.0)


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
    count = 2 * len(problem.views) + 1
    rows = [solution.lights + index for index in range(count)]
    everything = solution.covariance
    covariance = everything[np.ix_(rows, rows)]
    unexplained = solution.noise.own(solution.residuals)
    # To first order this is how far each pixel's residual alone moves the centre.
    scores = everything[rows] @ solution.design * solution.noise.weights * unexplained
    offsets = [
        view.pixels.points - shape.centre[:, None]
        for view, shape in zip(problem.views, fit.shapes, strict=True)
    ]
    # Both images of a joint fit share the sectors: what disturbs one side of a rim disturbs it in
    # both.
    x, y = np.concatenate(offsets, axis=1)
    independent = covariance
    seen = arc_covariance(scores, np.arctan2(y, x))
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
    centre = slice(2 * len(problem.views))
    inverse = np.linalg.inv(independent[centre, centre])
    misfit = float(np.trace(inverse @ seen[centre, centre])) / len(inverse)
    return RatedFit(fit, covariance, contrast, misfit)


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
    sector = ((azimuth + np.pi) / (2.0 * np.pi) * _BINS).astype(int) % _BINS
    sums = np.stack([np.bincount(sector, row, minlength=_BINS) for row in scores])
    return np.asarray(_LOST * sums @ _KERNEL @ sums.T)


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
