"""A rim with a ring round it, the chamfer of a thread or a narrow cone, in both images at once."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.fit import Fitted, PairPrior, finished, rough_rim_pair
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimShape
from cellctl.vision.rim.task import Task

_SLOPES = (0.0, 1.0)
"""A flat ring, and a cone of 90°."""
_WALL_M, _WALL_SIGMAS = 0.3e-3, 4.0
"""Depth of a relief above the first turn."""
_DIAMETER_SIGMA = 0.005
SIZE_TOLERANCE = 0.035
_BLUR_PX, _BLUR_SIGMA_PX, _KNOWN_BLUR_SIGMA_PX = 1.0, 0.25, 0.03
_RING_COST = 80.0
"""Fall of the squares that a ring must bring: real ones bring thousands."""
_PIXELS_ALIKE = 10.0
"""What a model leaves unexplained is alike in about so many pixels: evidence counts that less."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """The likeliest of several models of one rim."""

    fitted: Fitted
    spread: Array
    """Covariance of (x, y) in both images and the radius by the models that are nearly as likely,
    shape (5, 5), plane units squared."""


def fit_ringed(
    tasks: tuple[Task, Task],
    ring: tuple[float, float],
    blur_px: tuple[float, float] | None,
) -> Chosen:
    """The likeliest of the models with a ring, with a short wall, and with neither.

    ``ring`` is what is known of the ring's outer over its inner radius: mean and standard
    deviation; ``blur_px`` that of other rims in these images, where there are any. The outer edge
    of a cone lies nearer to the cameras than the rim and moves against it; the lower edge of a
    wall lies farther away.
    """
    blurs, blur_sigma = (_BLUR_PX, _BLUR_PX), _BLUR_SIGMA_PX
    if blur_px is not None:
        blurs, blur_sigma = blur_px, _KNOWN_BLUR_SIGMA_PX
    pixels, across_lay = (tasks[0].pixels, tasks[1].pixels), tasks[0].across_lay()

    def rough(sigma: float, **model: float) -> Fitted:
        first, second = (
            RimShape(task.centre, task.nominal, blur, **model)
            for task, blur in zip(tasks, blurs, strict=True)
        )
        prior = PairPrior(_DIAMETER_SIGMA, blur_sigma, sigma)
        return rough_rim_pair(pixels, (first, second), Light(thread=True), prior, across_lay)

    wall = _WALL_M / tasks[0].sight.distance_m
    models = [rough(ring[1], ring_ratio=ring[0], ring_slope=slope) for slope in _SLOPES]
    models += [rough(np.inf), rough(_WALL_SIGMAS * wall, wall_ratio=wall)]
    return _likeliest(models)


def _likeliest(models: list[Fitted]) -> Chosen:
    noise = models[0].solution.noise
    costs = np.array([model.solution.cost_under(noise) for model in models])
    costs[: len(_SLOPES)] += _RING_COST
    best = int(np.argmin(costs))
    likelihoods = np.exp(-0.5 * (costs - costs[best]) / _PIXELS_ALIKE)
    geometry = np.array([model.solution.vector[:5] for model in models])
    off = geometry - geometry[best]
    import os

    if os.environ.get("DBG"):
        print((costs - costs[best]).round(0), likelihoods.round(2), best)
    spread = (off * (likelihoods / likelihoods.sum())[:, None]).T @ off
    return Chosen(finished(models[best]), np.asarray(spread))
