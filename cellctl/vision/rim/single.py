"""A rim measured in one image, with nothing round it but an even face or a cone."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from cellctl.geometry.pose import Array
from cellctl.vision.rim.doubt import Doubt
from cellctl.vision.rim.fit import Fitted, Known, finished, fit_rim, rated, rough_rim
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimShape
from cellctl.vision.rim.result import Rim, refusal, rim_of
from cellctl.vision.rim.sight import Rejection
from cellctl.vision.rim.task import Task

_BLUR_PX = 1.0
_WALL_DEPTHS_M = (1e-3, 2e-3, 4e-3, 9e-3)
"""From a start above the true depth a fit converges; from far below it may not."""
_FAINT_GAIN, _HINT_GAIN, _CLEAR_GAIN = 2.0, 4.0, 60.0
"""Falls of the squares: worth a closer look, worth a fit with a wall, beyond doubt."""
_BORE_ODDS, _CONE_ODDS = 12.0, -15.0
"""What the information criterion of a fit with a wall may be worse by at even odds. Every bore has
a wall, and one that is hardly seen moves the rim all the same; under a cone the terms of its light
are easily taken for one."""


@dataclass(frozen=True, slots=True)
class Alone:
    """The likelier fit of a rim in one image, with a wall or without."""

    fitted: Fitted
    spread: Array
    """Covariance of the centre by the other fit, as far as it is likely, shape (2, 2), plane units
    squared."""


def fit_alone(task: Task) -> Alone:
    """The simplest model of the rim that the grey values do not contradict."""
    light = Light(cone=task.hole.kind == "countersink")
    bare = RimShape(task.centre, task.radius, _BLUR_PX)
    known = Known(task.nominal, task.across_lay())
    if task.hole.kind == "disc":
        return _certain(fit_rim(task.pixels, bare, light, known))
    rough = rough_rim(task.pixels, bare, light, known)
    ratios = [depth_m / task.sight.distance_m for depth_m in _WALL_DEPTHS_M]

    def walled(start: Fitted, ratio: float) -> Fitted:
        shape = replace(start.shapes[0], wall_ratio=ratio)
        return fit_rim(task.pixels, shape, light, known)

    doubt = Doubt(rough)
    ratio, gain = doubt.likely_wall(ratios)
    if gain > _CLEAR_GAIN:
        return _certain(walled(rough, ratio))
    plain = finished(rough)
    if gain < _FAINT_GAIN and not doubt.uneven_inside():
        return _certain(plain)
    doubt = Doubt(plain)
    ratio, gain = doubt.likely_wall(ratios)
    if gain < _HINT_GAIN and not doubt.uneven_inside():
        return _certain(plain)
    return _likelier(plain, walled(plain, ratio))


def _certain(fitted: Fitted) -> Alone:
    return Alone(fitted, np.zeros((2, 2)))


def _likelier(plain: Fitted, walled: Fitted) -> Alone:
    odds = _CONE_ODDS if plain.problem.light.cone else _BORE_ODDS
    for_wall = float(expit(0.5 * (plain.bic() - walled.bic() + odds)))
    off = walled.solution.vector[:2] - plain.solution.vector[:2]
    if for_wall > 0.5:
        return Alone(walled, np.outer(off, off) * (1.0 - for_wall))
    return Alone(plain, np.outer(off, off) * for_wall)


def rim_alone(task: Task, alone: Alone) -> Rim | Rejection:
    """What a fit in one image measures."""
    fit = rated(alone.fitted)
    refused = refusal(task, alone.fitted, fit, fit.shapes[0])
    return refused or rim_of(task, fit, fit.shapes[0], fit.covariance[:2, :2] + alone.spread)
