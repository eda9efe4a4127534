"""A rim measured in one image: pins, countersinks and discs."""

from dataclasses import replace

from cellctl.vision.features import Hole
from cellctl.vision.rim.fit import Fitted, finished, fit_rim, likely_wall, rated, rough_rim
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimShape
from cellctl.vision.rim.result import Rim, refusal, rim_of
from cellctl.vision.rim.sight import Located, Rejection, Sight
from cellctl.vision.rim.task import Task, task_for

_BLUR_PX = 1.0
_WALL_DEPTHS_M = (0.5e-3, 1e-3, 2e-3, 4e-3, 9e-3)
_FAINT_GAIN, _HINT_GAIN, _CLEAR_GAIN = 2.0, 12.0, 60.0
"""Falls of the squares: worth a closer look, worth a fit with a wall, beyond doubt."""
_EVIDENCE = 15.0
"""Fall of the information criterion that a more complex model must bring."""


def measure_rim(sight: Sight, hole: Hole, located: Located) -> Rim | Rejection:
    """Measure a located rim in one image; its plane must be known to about a degree."""
    task = task_for(sight, hole, located)
    if isinstance(task, Rejection):
        return task
    fitted = _fit_alone(task)
    fit = rated(fitted)
    refused = refusal(task, fitted, fit, fit.shapes[0])
    return refused or rim_of(task, fit, fit.shapes[0], fit.covariance[:2, :2])


def _fit_alone(task: Task) -> Fitted:
    """The simplest model of the rim that the grey values do not contradict."""
    pixels, lay = task.pixels, task.across_lay()
    light = Light(cone=task.hole.kind == "countersink")
    bare = RimShape(task.centre, task.radius, _BLUR_PX)
    if task.hole.kind == "disc":
        return fit_rim(pixels, bare, light, lay)
    ratios = [depth_m / task.sight.distance_m for depth_m in _WALL_DEPTHS_M]
    rough = rough_rim(pixels, bare, light, lay)
    ratio, gain = likely_wall(rough, ratios)
    if gain > _CLEAR_GAIN:
        return fit_rim(pixels, replace(rough.shapes[0], wall_ratio=ratio), light, lay)
    plain = finished(rough)
    if gain < _FAINT_GAIN:
        return plain
    ratio, gain = likely_wall(plain, ratios)
    if gain < _HINT_GAIN:
        return plain
    walled = fit_rim(pixels, replace(plain.shapes[0], wall_ratio=ratio), light, lay)
    return walled if walled.bic() < plain.bic() - _EVIDENCE else plain
