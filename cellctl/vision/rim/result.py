"""A measured rim, and when a fit is none."""

from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.ellipse import Ellipse, ellipse_of_circle
from cellctl.vision.rim.fit import Fitted, RimFit
from cellctl.vision.rim.model import RimShape
from cellctl.vision.rim.sight import RADIUS_TOLERANCE, Rejection
from cellctl.vision.rim.task import Task

FLOOR_PX = 5e-4
"""Lens model and pixel response limit every centre to about this."""

_MIN_CONTRAST_GREY = 8.0
_MAX_MOVE_PX = 2.5


@dataclass(frozen=True, slots=True)
class Rim:
    """A measured rim."""

    point_px: Array
    """Raw pixel onto which the centre of the circle projects, shape (2,)."""
    covariance_px2: Array
    """Shape (2, 2)."""
    ellipse: Ellipse
    """The rim in the raw image, for pictures."""
    size_ratio: float
    """Measured over nominal diameter, if the plane's distance is right."""
    residual_grey: float
    blur_px: float
    wall_depth_m: float | None


def refusal(
    task: Task,
    fitted: Fitted,
    fit: RimFit,
    shape: RimShape,
    size_tolerance: float = RADIUS_TOLERANCE,
) -> Rejection | None:
    """Why a fit is no measurement of the rim in one image; None when it is."""
    moved_px = float(np.linalg.norm(shape.centre - task.centre)) / task.patch.unit_px
    if not fitted.converged:
        return Rejection("fit of the rim did not settle")
    if abs(fit.contrast_grey) < _MIN_CONTRAST_GREY:
        return Rejection("too little contrast at the rim")
    if moved_px > _MAX_MOVE_PX or abs(shape.radius / task.nominal - 1.0) > size_tolerance:
        return Rejection("fitted rim does not have the nominal size and place")
    return None


def rim_of(task: Task, fit: RimFit, shape: RimShape, covariance: Array) -> Rim:
    """The fit in one image in raw pixels; ``covariance`` (2, 2) in plane units squared."""
    jacobian = task.patch.px_by_point(shape.centre)
    point_px = task.patch.to_px(shape.centre[None])[0]
    wall = shape.wall_ratio
    return Rim(
        point_px=point_px,
        covariance_px2=jacobian @ covariance @ jacobian.T + np.eye(2) * FLOOR_PX**2,
        ellipse=ellipse_of_circle(point_px, jacobian * shape.radius),
        size_ratio=shape.radius / task.nominal,
        residual_grey=fit.residual_grey,
        blur_px=shape.blur_px,
        wall_depth_m=None if wall is None else wall * task.sight.distance_m,
    )
