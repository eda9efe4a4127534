"""The rim of a thread and its chamfer, measured in both images at once."""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.features import Hole
from cellctl.vision.rim.fit import Fitted, RingPrior, finished, rated, rough_rim_pair
from cellctl.vision.rim.light import Light
from cellctl.vision.rim.model import RimShape
from cellctl.vision.rim.result import FLOOR_PX, Rim, refusal, rim_of
from cellctl.vision.rim.sight import Located, Rejection, Sight
from cellctl.vision.rim.task import Task, task_for

_CHAMFER_RATIO, _CHAMFER_SIGMA = 1.1, 0.05
_CHAMFER_SLOPES = (0.0, 1.0)
"""Flat, and a cone of 90°."""
_DIAMETER_SIGMA = 0.01
_SIZE_TOLERANCE = 3.5 * _DIAMETER_SIGMA
_BLUR_PX, _BLUR_SIGMA_PX, _KNOWN_BLUR_SIGMA_PX = 1.0, 0.25, 0.03


def measure_thread(
    sights: tuple[Sight, Sight],
    hole: Hole,
    located: tuple[Located, Located],
    blur_px: tuple[float, float] | None,
) -> tuple[Rim, Rim, Array] | Rejection:
    """Measure the rim of a thread and its chamfer in both images at once.

    ``blur_px`` is the blur of other rims in these images, where there are any. Third of the result
    is the joint covariance of both points, shape (4, 4), px².
    """
    tasks = []
    for sight, place in zip(sights, located, strict=True):
        task = task_for(sight, hole, place)
        if isinstance(task, Rejection):
            return task
        tasks.append(task)
    left, right = tasks
    fitted = _fit(left, right, blur_px)
    fit = rated(fitted)
    for task, shape in zip(tasks, fit.shapes, strict=True):
        refused = refusal(task, fitted, fit, shape, _SIZE_TOLERANCE)
        if refused is not None:
            return refused
    jacobian = np.zeros((4, 4))
    jacobian[:2, :2] = left.patch.px_by_point(fit.shapes[0].centre)
    jacobian[2:, 2:] = right.patch.px_by_point(fit.shapes[1].centre)
    joint = jacobian @ fit.covariance[:4, :4] @ jacobian.T + np.eye(4) * FLOOR_PX**2
    rims = [
        rim_of(task, fit, fit.shapes[index], fit.covariance[part, part])
        for index, (task, part) in enumerate(zip(tasks, (slice(2), slice(2, 4)), strict=True))
    ]
    return rims[0], rims[1], joint


def _fit(left: Task, right: Task, blur_px: tuple[float, float] | None) -> Fitted:
    """With the chamfer flat or as a cone, whichever the images show.

    The outer edge of a cone lies nearer to the cameras than the rim and moves against it.
    """
    blurs, blur_sigma = ((_BLUR_PX, _BLUR_PX), _BLUR_SIGMA_PX)
    if blur_px is not None:
        blurs, blur_sigma = blur_px, _KNOWN_BLUR_SIGMA_PX
    prior = RingPrior(_DIAMETER_SIGMA, _CHAMFER_RATIO, _CHAMFER_SIGMA, blur_sigma)

    pixels, across_lay = (left.pixels, right.pixels), left.across_lay()

    def rough(slope: float) -> Fitted:
        first, second = (
            RimShape(task.centre, task.nominal, blur, None, _CHAMFER_RATIO, slope)
            for task, blur in zip((left, right), blurs, strict=True)
        )
        return rough_rim_pair(pixels, (first, second), Light(thread=True), prior, across_lay)

    models = [rough(slope) for slope in _CHAMFER_SLOPES]
    noise = models[0].solution.noise
    return finished(min(models, key=lambda model: model.solution.cost_under(noise)))
