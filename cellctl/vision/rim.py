"""The rim of one hole in one image or in both: where its centre projects to, and how surely."""

from dataclasses import dataclass, replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera import project
from cellctl.vision.ellipse import Ellipse, ellipse_from_points
from cellctl.vision.features import Hole
from cellctl.vision.plane_patch import PlanePatch, plane_basis, plane_patch, to_plane
from cellctl.vision.rim_edges import edge_circle
from cellctl.vision.rim_fit import (
    Fitted,
    RimFit,
    RingPrior,
    finished,
    fit_rim,
    fit_rim_pair,
    likely_wall,
    rated,
    rough_rim,
)
from cellctl.vision.rim_lay import lay_across
from cellctl.vision.rim_light import Light
from cellctl.vision.rim_model import RimPixels, RimShape
from cellctl.vision.stereo_head import CameraModel

_RADIUS_TOLERANCE = 0.07
_MIN_SUPPORT = 0.55
_MIN_CONTRAST_GREY = 8.0
_MAX_MOVE_PX = 2.5
_BAND_INSIDE_PX, _THREAD_INSIDE_PX, _BAND_OUTSIDE_PX = 6.5, 3.0, 5.5
_DENSE_PX, _THREAD_DENSE_PX = 3.0, 5.0
_WALL_DEPTHS_M = (0.5e-3, 1e-3, 2e-3, 4e-3, 9e-3)
_FAINT_GAIN, _HINT_GAIN, _CLEAR_GAIN = 2.0, 12.0, 60.0
"""Falls of the squares: worth a closer look, worth a fit with a wall, beyond doubt."""
_EVIDENCE = 15.0
"""Fall of the information criterion that a more complex model must bring."""
_CHAMFER_RATIO, _CHAMFER_SIGMA = 1.1, 0.05
_CHAMFER_CLEAR, _RIM_CLEAR = 1.15, 1.0
_DIAMETER_SIGMA = 0.01
_BLUR_PX, _BLUR_SIGMA_PX, _KNOWN_BLUR_SIGMA_PX = 1.0, 0.25, 0.03
_FLOOR_PX = 1e-3
"""Lens model and pixel response limit every centre to about this."""


@dataclass(frozen=True, slots=True)
class Sight:
    """Where to look for a rim in one image."""

    image: Image
    camera: CameraModel
    centre_m: Array
    """Shape (3,), in the frame of the camera."""
    normal: Array
    """Unit normal of the rim's plane, away from the camera."""
    across: Array
    """A direction common to all cameras of the head; azimuths count from it."""

    @property
    def distance_m(self) -> float:
        """From the camera to the rim's plane."""
        return float(self.normal @ self.centre_m)


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


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why there is no rim."""

    reason: str


@dataclass(frozen=True, slots=True)
class Located:
    """A rim located by its edges, to a fraction of a pixel."""

    point_px: Array
    """Raw pixel of its centre, shape (2,)."""
    size_ratio: float
    """Measured over nominal diameter, if the plane's distance is right."""
    support: float
    """Share of the circumference that shows an edge."""


def locate_rim(sight: Sight, hole: Hole, reach_px: float) -> Located | Rejection:
    """Find the rim within ``reach_px`` of where it should be, by its edges alone."""
    patch = _patch(sight, hole, reach_px)
    if patch is None:
        return Rejection("lies outside the image")
    nominal = hole.diameter_m / 2.0 / sight.distance_m
    circle = edge_circle(
        sight.image,
        patch,
        patch.basis @ sight.centre_m / sight.distance_m,
        nominal,
        reach_px=reach_px,
        radius_tolerance=_RADIUS_TOLERANCE,
        bright=hole.kind == "disc",
    )
    if circle is None:
        return Rejection("no round edge of the nominal size")
    if circle.support < _MIN_SUPPORT:
        return Rejection(f"only {circle.support:.0%} of the rim has an edge")
    return Located(patch.to_px(circle.centre[None])[0], circle.radius / nominal, circle.support)


def measure_rim(sight: Sight, hole: Hole, located: Located) -> Rim | Rejection:
    """Measure a located rim in one image; its plane must be known to about a degree."""
    task = _task(sight, hole, located)
    if isinstance(task, Rejection):
        return task
    fitted = _fit_alone(task)
    fit = rated(fitted)
    refusal = _refusal(task, fitted, fit, fit.shapes[0])
    return refusal or _rim(task, fit, fit.shapes[0], fit.covariance[:2, :2])


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
        task = _task(sight, hole, place)
        if isinstance(task, Rejection):
            return task
        tasks.append(task)
    left, right = tasks
    blurs, blur_sigma = ((_BLUR_PX, _BLUR_PX), _BLUR_SIGMA_PX)
    if blur_px is not None:
        blurs, blur_sigma = blur_px, _KNOWN_BLUR_SIGMA_PX
    starts = [
        RimShape(task.centre, task.nominal, blur, None, _CHAMFER_RATIO)
        for task, blur in zip(tasks, blurs, strict=True)
    ]
    fitted = fit_rim_pair(
        (left.pixels, right.pixels),
        (starts[0], starts[1]),
        Light(thread=True),
        RingPrior(_DIAMETER_SIGMA, _CHAMFER_RATIO, _CHAMFER_SIGMA, blur_sigma),
        left.across_lay,
    )
    fit = rated(fitted)
    for task, shape in zip(tasks, fit.shapes, strict=True):
        refusal = _refusal(task, fitted, fit, shape)
        if refusal is not None:
            return refusal
    jacobian = np.zeros((4, 4))
    jacobian[:2, :2] = left.patch.px_by_point(fit.shapes[0].centre)
    jacobian[2:, 2:] = right.patch.px_by_point(fit.shapes[1].centre)
    joint = jacobian @ fit.covariance[:4, :4] @ jacobian.T + np.eye(4) * _FLOOR_PX**2
    rims = [
        _rim(task, fit, fit.shapes[index], fit.covariance[part, part])
        for index, (task, part) in enumerate(zip(tasks, (slice(2), slice(2, 4)), strict=True))
    ]
    return rims[0], rims[1], joint


@dataclass(frozen=True, slots=True)
class _Task:
    """A located rim with the pixels that its model describes."""

    sight: Sight
    hole: Hole
    patch: PlanePatch
    pixels: RimPixels
    centre: Array
    """Start in plane units, shape (2,)."""
    radius: float
    """Start in plane units."""
    nominal: float
    """Nominal radius in plane units."""
    across_lay: Array | None
    """Across the lay of the face beside the rim, shape (2,); None without one."""


def _patch(sight: Sight, hole: Hole, reach_px: float) -> PlanePatch | None:
    """The plane round a hole's expected place, or None when it is cut off by the image's border."""
    middle = project(sight.camera, sight.centre_m[None])[0]
    focal = float(sight.camera.camera_matrix[0, 0])
    radius_px = focal * hole.diameter_m / 2.0 / float(sight.centre_m[2])
    half = radius_px * (1.0 + _RADIUS_TOLERANCE) + reach_px + _BAND_OUTSIDE_PX + 2.0
    size = np.array(sight.image.shape[::-1])
    if (middle < half).any() or (middle > size - 1 - half).any():
        return None
    basis = plane_basis(sight.normal, sight.across)
    return plane_patch(sight.camera, sight.normal, basis, middle, half)


def _task(sight: Sight, hole: Hole, located: Located) -> _Task | Rejection:
    patch = _patch(sight, hole, 1.0)
    if patch is None:
        return Rejection("lies outside the image")
    nominal = hole.diameter_m / 2.0 / sight.distance_m
    centre = to_plane(sight.camera, located.point_px[None], patch.normal, patch.basis)[0]
    radius = nominal * located.size_ratio
    pixels = _band(sight, hole, patch, located.point_px, radius)
    across = None
    if hole.countersink_m is None:
        clear = _CHAMFER_CLEAR if hole.kind == "thread" else _RIM_CLEAR
        clear_px = clear * radius / patch.unit_px + 3.0
        across = lay_across(sight.image, patch, located.point_px, clear_px)
    return _Task(sight, hole, patch, pixels, centre, radius, nominal, across)


def _band(
    sight: Sight, hole: Hole, patch: PlanePatch, middle_px: Array, radius: float
) -> RimPixels:
    """The pixels near the rim: all where it lies, one in three where only levels are needed."""
    radius_px = radius / patch.unit_px
    inside, outside, dense = min(_BAND_INSIDE_PX, 0.5 * radius_px), _BAND_OUTSIDE_PX, _DENSE_PX
    if hole.kind == "thread":
        inside, dense = _THREAD_INSIDE_PX, _THREAD_DENSE_PX
    elif hole.countersink_m is not None:
        ring_px = radius_px * (hole.countersink_m / hole.diameter_m - 1.0)
        outside = min(outside, max(2.0, 0.7 * ring_px))
    x0, y0 = np.floor(middle_px - 1.15 * radius_px - outside).astype(int)
    x1, y1 = np.ceil(middle_px + 1.15 * radius_px + outside).astype(int) + 1
    height, width = sight.image.shape
    columns, rows = np.meshgrid(
        np.arange(max(x0, 0), min(x1, width)), np.arange(max(y0, 0), min(y1, height))
    )
    # In the middle of the patch the map to the plane is linear enough to choose pixels by.
    _, jacobian = patch.from_px(middle_px[:1], middle_px[1:])
    dx, dy = columns - middle_px[0], rows - middle_px[1]
    along, across = (jacobian[i, 0, 0] * dx + jacobian[i, 1, 0] * dy for i in (0, 1))
    distance = np.hypot(along, across) / patch.unit_px - radius_px
    wanted = (distance > -inside) & (distance < outside)
    wanted &= (np.abs(distance) < dense) | ((columns + rows) % 3 == 0)
    columns, rows = columns[wanted], rows[wanted]
    points, jacobians = patch.from_px(columns.astype(float), rows.astype(float))
    grey = sight.image[rows, columns].astype(float)
    return RimPixels(points, jacobians, grey, np.stack([columns, rows]), patch.unit_px)


def _fit_alone(task: _Task) -> Fitted:
    """The simplest model of the rim that the grey values do not contradict."""
    pixels, lay = task.pixels, task.across_lay
    light = Light(cone=task.hole.countersink_m is not None)
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


def _refusal(task: _Task, fitted: Fitted, fit: RimFit, shape: RimShape) -> Rejection | None:
    moved_px = float(np.linalg.norm(shape.centre - task.centre)) / task.patch.unit_px
    if not fitted.converged:
        return Rejection("fit of the rim did not settle")
    if abs(fit.contrast_grey) < _MIN_CONTRAST_GREY:
        return Rejection("too little contrast at the rim")
    if moved_px > _MAX_MOVE_PX or abs(shape.radius / task.nominal - 1.0) > _RADIUS_TOLERANCE:
        return Rejection("fitted rim does not have the nominal size and place")
    return None


def _rim(task: _Task, fit: RimFit, shape: RimShape, covariance: Array) -> Rim:
    jacobian = task.patch.px_by_point(shape.centre)
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = shape.centre + shape.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    wall = shape.wall_ratio
    return Rim(
        point_px=task.patch.to_px(shape.centre[None])[0],
        covariance_px2=jacobian @ covariance @ jacobian.T + np.eye(2) * _FLOOR_PX**2,
        ellipse=ellipse_from_points(task.patch.to_px(circle)),
        size_ratio=shape.radius / task.nominal,
        residual_grey=fit.residual_grey,
        blur_px=shape.blur_px,
        wall_depth_m=None if wall is None else wall * task.sight.distance_m,
    )
