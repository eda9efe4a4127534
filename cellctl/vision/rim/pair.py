"""A rim measured in both images, by the simplest model that their grey values do not contradict."""

from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.features import Hole
from cellctl.vision.rim.doubt import Doubt
from cellctl.vision.rim.fit import Fitted, rated
from cellctl.vision.rim.result import FLOOR_PX, Rim, refusal, rim_of
from cellctl.vision.rim.ringed import SIZE_TOLERANCE, Chosen, fit_ringed
from cellctl.vision.rim.sight import SIDES, Located, Rejection, Sight
from cellctl.vision.rim.single import Alone, fit_alone, rim_alone
from cellctl.vision.rim.task import Task, task_for
from cellctl.vision.stereo import joint_covariance

_NARROW_PX = 5.0
"""A cone narrower than this is a ring: both its edges are seen at once."""
_CHAMFER, _BROKEN_EDGE = (0.1, 0.05), (0.07, 0.05)
_UNSEEN_CONE = (0.15, 0.08)
"""Width of a ring over the radius, and its standard deviation."""
_STATED_SHARE, _SEEN_SHARE = 0.1, 0.2
"""Standard deviation of that width over itself, by the drawing and by the image."""
_BROKEN_EDGE_GAIN = 25.0
"""What a ring must explain in both images together before a bore counts as deburred: walls of
uneven light alone stay below."""
_LEAST_RING_PX = 2.0
_MAX_SIGMA_PX = 0.2


@dataclass(frozen=True, slots=True)
class RimPair:
    """One rim in both images."""

    left: Rim
    right: Rim
    covariance_px2: Array
    """Of both points, left first, shape (4, 4)."""


def measure_rims(
    sights: tuple[Sight, Sight],
    hole: Hole,
    located: tuple[Located, Located],
    blur_px: tuple[float, float] | None,
) -> RimPair | Rejection:
    """Measure a located rim, whose plane must be known to about a degree.

    ``blur_px`` is the blur of other rims in these images, where there are any.
    """
    ring_px = _LEAST_RING_PX if hole.kind == "thread" else None
    tasks = _tasks(sights, hole, located, ring_px)
    if isinstance(tasks, Rejection):
        return tasks
    fits = (fit_alone(tasks[0]), fit_alone(tasks[1]))
    if not _ring_needed(hole, tasks, (fits[0].fitted, fits[1].fitted)):
        return _apart(tasks, fits)
    ratio, sigma = _ring(hole, tasks)
    ring_px = max(_LEAST_RING_PX, ratio * tasks[0].radius / tasks[0].patch.unit_px)
    tasks = _tasks(sights, hole, located, ring_px)
    if isinstance(tasks, Rejection):
        return tasks
    return _together(tasks, fit_ringed(tasks, (1.0 + ratio, sigma), blur_px))


def _tasks(
    sights: tuple[Sight, Sight],
    hole: Hole,
    located: tuple[Located, Located],
    ring_px: float | None,
) -> tuple[Task, Task] | Rejection:
    tasks = []
    for side, sight, place in zip(SIDES, sights, located, strict=True):
        task = task_for(sight, hole, place, ring_px)
        if isinstance(task, Rejection):
            return replace(task, side=side)
        tasks.append(task)
    return tasks[0], tasks[1]


def _ring_needed(hole: Hole, tasks: tuple[Task, Task], fits: tuple[Fitted, Fitted]) -> bool:
    """Whether a ring or an uneven inside must be modelled too."""
    if hole.kind == "thread":
        if not all(fit.converged for fit in fits):
            return True
        return any(doubt.ring() or doubt.uneven_inside() for doubt in map(Doubt, fits))
    if hole.kind == "countersink":
        narrow = any(task.clear_px < _NARROW_PX for task in tasks)
        return narrow or any(Doubt(fit).ring() for fit in fits)
    return hole.kind == "pin" and sum(Doubt(fit).ring_gain() for fit in fits) > _BROKEN_EDGE_GAIN


def _ring(hole: Hole, tasks: tuple[Task, Task]) -> tuple[float, float]:
    """Width of a ring over the radius and its standard deviation, as far as known."""
    if hole.kind == "thread":
        return _CHAMFER
    if hole.kind == "pin":
        return _BROKEN_EDGE
    narrow = _NARROW_PX * tasks[0].patch.unit_px / tasks[0].radius
    stated = (hole.countersink_m or np.inf) / hole.diameter_m - 1.0
    if stated < narrow:
        return stated, _STATED_SHARE * stated
    seen = [
        task.clear_px * task.patch.unit_px / task.radius
        for task in tasks
        if np.isfinite(task.clear_px)
    ]
    return (float(np.mean(seen)), _SEEN_SHARE * float(np.mean(seen))) if seen else _UNSEEN_CONE


def _apart(tasks: tuple[Task, Task], fits: tuple[Alone, Alone]) -> RimPair | Rejection:
    """Fits of each image for itself."""
    rims = []
    for side, task, alone in zip(SIDES, tasks, fits, strict=True):
        rim = rim_alone(task, alone)
        if isinstance(rim, Rejection):
            return replace(rim, side=side)
        rims.append(rim)
    joint = joint_covariance(rims[0].covariance_px2, rims[1].covariance_px2)
    return RimPair(rims[0], rims[1], joint)


def _together(tasks: tuple[Task, Task], chosen: Chosen) -> RimPair | Rejection:
    """One fit of both images."""
    fitted, fit = chosen.fitted, rated(chosen.fitted)
    fit = replace(fit, covariance=fit.covariance + chosen.spread)
    jacobian = np.zeros((4, 4))
    rims = []
    for index, (task, shape) in enumerate(zip(tasks, fit.shapes, strict=True)):
        refused = refusal(task, fitted, fit, shape, SIZE_TOLERANCE)
        if refused is not None:
            return replace(refused, side=SIDES[index])
        part = slice(2 * index, 2 * index + 2)
        jacobian[part, part] = task.patch.px_by_point(shape.centre)
        rims.append(rim_of(task, fit, shape, fit.covariance[part, part]))
    joint = jacobian @ fit.covariance[:4, :4] @ jacobian.T + np.eye(4) * FLOOR_PX**2
    return RimPair(rims[0], rims[1], joint)


def vague(rims: RimPair) -> Rejection | None:
    """Refusal of rims whose centre the grey values leave open: no contrast to what lies beside."""
    for side, rim in zip(SIDES, (rims.left, rims.right), strict=True):
        sigma_px = float(np.sqrt(np.linalg.eigvalsh(rim.covariance_px2)[-1]))
        if sigma_px > _MAX_SIGMA_PX:
            reason = f"centre known to {sigma_px:.2f} px only, allowed {_MAX_SIGMA_PX:.2f} px"
            return Rejection(reason, side)
    return None
