"""A rim measured in one image, with nothing round it but an even face or a cone."""

from dataclasses import replace

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
_FAINT_GAIN, _HINT_GAIN, _CLEAR_GAIN = 2.0, 12.0, 60.0
"""Falls of the squares: worth a closer look, worth a fit with a wall, beyond doubt."""
_EVIDENCE = 15.0
"""Fall of the information criterion that a more complex model must bring."""


def fit_alone(task: Task) -> Fitted:
    """The simplest model of the rim that the grey values do not contradict."""
    light = Light(cone=task.hole.kind == "countersink")
    bare = RimShape(task.centre, task.radius, _BLUR_PX)
    known = Known(task.nominal, task.across_lay())
    if task.hole.kind == "disc":
        return fit_rim(task.pixels, bare, light, known)
    rough = rough_rim(task.pixels, bare, light, known)
    ratios = [depth_m / task.sight.distance_m for depth_m in _WALL_DEPTHS_M]

    def walled(start: Fitted, ratio: float) -> Fitted:
        shape = replace(start.shapes[0], wall_ratio=ratio)
        return fit_rim(task.pixels, shape, light, known)

    doubt = Doubt(rough)
    ratio, gain = doubt.likely_wall(ratios)
    if gain > _CLEAR_GAIN:
        return walled(rough, ratio)
    plain = finished(rough)
    if gain < _FAINT_GAIN and not doubt.uneven_inside():
        return plain
    doubt = Doubt(plain)
    ratio, gain = doubt.likely_wall(ratios)
    if gain < _HINT_GAIN and not doubt.uneven_inside():
        return plain
    other = walled(plain, ratio)
    return other if other.bic() < plain.bic() - _EVIDENCE else plain


def rim_alone(task: Task, fitted: Fitted) -> Rim | Rejection:
    """What a fit in one image measures."""
    fit = rated(fitted)
    refused = refusal(task, fitted, fit, fit.shapes[0])
    return refused or rim_of(task, fit, fit.shapes[0], fit.covariance[:2, :2])
