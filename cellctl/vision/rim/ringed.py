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
SIZE_TOLERANCE = 0.035
"""Relative: from here on it is another edge."""
_BLUR_PX, _BLUR_SIGMA_PX, _KNOWN_BLUR_SIGMA_PX = 1.0, 0.25, 0.03
_RING_COST = 80.0
"""Fall of the squares that a ring round turns must bring: real ones bring thousands. A bore has no
turns that could be taken for one."""
_CALM_GREY, _CALM_LIMIT_GREY, _WILD_GREY = 15.0, 12.5, 50.0
"""How uneven turns are expected to be; beyond the limit far more is allowed for, and stated."""
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

    def rough(turns_grey: float, sigma: float, **model: float) -> Fitted:
        first, second = (
            RimShape(task.centre, task.nominal, blur, **model)
            for task, blur in zip(tasks, blurs, strict=True)
        )
        prior, light = PairPrior(blur_sigma, sigma), Light(turns_grey=turns_grey)
        return rough_rim_pair(pixels, (first, second), light, prior, across_lay)

    def likeliest(turns_grey: float) -> Chosen:
        wall = _WALL_M / tasks[0].sight.distance_m
        models = [
            *(rough(turns_grey, ring[1], ring_ratio=ring[0], ring_slope=s) for s in _SLOPES),
            rough(turns_grey, np.inf),
            rough(turns_grey, _WALL_SIGMAS * wall, wall_ratio=wall),
        ]
        return _likeliest(models, 0.0 if tasks[0].hole.kind == "pin" else _RING_COST)

    calm = likeliest(_CALM_GREY)
    if calm.fitted.solution.unevenness_grey(_CALM_GREY) < _CALM_LIMIT_GREY:
        return calm
    wild = likeliest(_WILD_GREY)
    off = wild.fitted.solution.vector[:5] - calm.fitted.solution.vector[:5]
    return Chosen(wild.fitted, wild.spread + np.outer(off, off))


def _likeliest(models: list[Fitted], ring_cost: float) -> Chosen:
    noise = models[0].solution.noise
    ringed = np.array([model.shapes[0].ring_ratio is not None for model in models])
    costs = np.array([model.solution.cost_under(noise) for model in models]) + ring_cost * ringed
    best = int(np.argmin(costs))
    likelihoods = np.exp(-0.5 * (costs - costs[best]) / _PIXELS_ALIKE)
    geometry = np.array([model.solution.vector[:5] for model in models])
    off = geometry - geometry[best]
    spread = (off * (likelihoods / likelihoods.sum())[:, None]).T @ off
    return Chosen(finished(models[best]), np.asarray(spread))
