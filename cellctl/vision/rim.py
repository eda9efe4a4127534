"""The rim of one hole in one image: where its centre projects to, and how sure that is."""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera import PlanePatch, plane_patch, project
from cellctl.vision.ellipse import Ellipse, ellipse_from_points
from cellctl.vision.features import Hole
from cellctl.vision.rim_edges import EdgeCircle, edge_circle, plane_to_px, plane_units_per_px
from cellctl.vision.rim_fit import Prior, RimFit, fit_rim, rim_cost
from cellctl.vision.rim_light import Light
from cellctl.vision.rim_model import RimPixels, RimShape, rim_distance_px
from cellctl.vision.stereo_head import CameraModel

_RADIUS_TOLERANCE = 0.07
_MIN_SUPPORT = 0.55
_MIN_CONTRAST_GREY = 8.0
_BAND_INSIDE_PX, _BAND_OUTSIDE_PX = 7.0, 6.0
_THREAD_INSIDE_PX = 3.0
_WALL_DEPTHS_M = (0.6e-3, 1.5e-3, 3e-3, 6e-3, 12e-3)
_CHAMFER_RATIO, _CHAMFER_SIGMA = 1.1, 0.05
_DIAMETER_SIGMA = 0.01
_BIC_EVIDENCE = 12.0
_FLOOR_PX = 1e-3
"""Lens model and pixel response limit every centre to about this."""


@dataclass(frozen=True, slots=True)
class View:
    """One camera's image."""

    image: Image
    camera: CameraModel


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
    size_sigma: float
    contrast_grey: float
    residual_grey: float
    blur_px: float
    wall_depth_m: float | None


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why there is no rim."""

    reason: str


def coarse_rim(
    view: View, hole: Hole, centre_m: Array, normal: Array, reach_px: float
) -> Array | Rejection:
    """Raw pixel of the centre from edge points alone; good to a fraction of a pixel."""
    found = _edges(view, hole, centre_m, normal, reach_px)
    if isinstance(found, Rejection):
        return found
    patch, circle, _ = found
    return plane_to_px(view.camera, patch, circle.centre[None])[0]


def measure_rim(
    view: View, hole: Hole, centre_m: Array, normal: Array, reach_px: float
) -> Rim | Rejection:
    """Measure a rim whose centre and plane are known to about ``reach_px`` and a degree.

    ``centre_m`` and unit ``normal`` (pointing away from the camera) in the frame of the camera.
    """
    found = _edges(view, hole, centre_m, normal, reach_px)
    if isinstance(found, Rejection):
        return found
    patch, circle, grey = found
    distance_m = float(normal @ centre_m)
    fit = _best_fit(patch, circle, grey, hole, distance_m)
    nominal = hole.diameter_m / 2.0 / distance_m
    px = plane_units_per_px(patch)
    moved_px = float(np.linalg.norm(fit.shape.centre - circle.centre)) / px
    if not fit.converged:
        return Rejection("fit of the rim did not settle")
    if abs(fit.contrast_grey) < _MIN_CONTRAST_GREY:
        return Rejection("too little contrast at the rim")
    if moved_px > 2.5 or abs(fit.shape.radius / nominal - 1.0) > _RADIUS_TOLERANCE:
        return Rejection("fitted rim does not have the nominal size")
    return _rim(view, patch, fit, nominal, distance_m)


def _edges(
    view: View, hole: Hole, centre_m: Array, normal: Array, reach_px: float
) -> tuple[PlanePatch, EdgeCircle, Array] | Rejection:
    nominal = hole.diameter_m / 2.0 / float(normal @ centre_m)
    patch_grey = _cut(view, hole, centre_m, normal, reach_px)
    if patch_grey is None:
        return Rejection("lies outside the image")
    patch, grey = patch_grey
    smoothed = cv2.GaussianBlur(grey, (0, 0), 1.0)
    circle = edge_circle(
        smoothed,
        patch,
        view.camera,
        patch.basis @ centre_m / float(normal @ centre_m),
        nominal,
        reach_px=reach_px,
        radius_tolerance=_RADIUS_TOLERANCE,
        bright=hole.kind == "disc",
    )
    if circle is None:
        return Rejection("no round edge of the nominal size")
    if circle.support < _MIN_SUPPORT:
        return Rejection(f"only {circle.support:.0%} of the rim has an edge")
    return patch, circle, grey


def _cut(
    view: View, hole: Hole, centre_m: Array, normal: Array, reach_px: float
) -> tuple[PlanePatch, Array] | None:
    middle = project(view.camera, centre_m[None])[0]
    radius_px = view.camera.camera_matrix[0, 0] * hole.diameter_m / 2.0 / centre_m[2]
    half = int(np.ceil(radius_px * (1.0 + _RADIUS_TOLERANCE) + reach_px + _BAND_OUTSIDE_PX + 2.0))
    x0, y0 = (int(value) - half for value in np.rint(middle))
    size = 2 * half + 1
    height, width = view.image.shape
    if x0 < 0 or y0 < 0 or x0 + size > width or y0 + size > height:
        return None
    grey = view.image[y0 : y0 + size, x0 : x0 + size].astype(float)
    return plane_patch(view.camera, normal, (x0, y0), (size, size)), grey


def _best_fit(
    patch: PlanePatch, circle: EdgeCircle, grey: Array, hole: Hole, distance_m: float
) -> RimFit:
    """The simplest model of the rim that the grey values do not contradict."""
    nominal = hole.diameter_m / 2.0 / distance_m
    pixels = _band(patch, circle, grey, hole)
    if hole.kind == "thread":
        start = RimShape(circle.centre, nominal, 1.0, None, _CHAMFER_RATIO)
        sigma = np.array([np.inf, np.inf, _DIAMETER_SIGMA * nominal, 0.3, _CHAMFER_SIGMA])
        return fit_rim(pixels, start, Light(thread=True), Prior(start.vector, sigma))
    light = Light(cone=hole.countersink_m is not None)
    plain = fit_rim(pixels, RimShape(circle.centre, circle.radius, 1.0), light)
    if hole.kind == "disc":
        return plain
    starts = [
        RimShape(circle.centre, circle.radius, plain.shape.blur_px, depth / distance_m)
        for depth in _WALL_DEPTHS_M
    ]
    start = min(starts, key=lambda shape: rim_cost(pixels, shape, light))
    walled = fit_rim(pixels, start, light)
    return walled if walled.converged and walled.bic < plain.bic - _BIC_EVIDENCE else plain


def _band(patch: PlanePatch, circle: EdgeCircle, grey: Array, hole: Hole) -> RimPixels:
    everything = RimPixels(
        patch.points.reshape(-1, 2), patch.jacobian.reshape(-1, 2, 2), grey.ravel()
    )
    distance = rim_distance_px(everything, circle.centre, circle.radius)
    radius_px = circle.radius / plane_units_per_px(patch)
    inside, outside = min(_BAND_INSIDE_PX, 0.5 * radius_px), _BAND_OUTSIDE_PX
    if hole.kind == "thread":
        inside = _THREAD_INSIDE_PX
    if hole.countersink_m is not None:
        ring_px = radius_px * (hole.countersink_m / hole.diameter_m - 1.0)
        outside = min(outside, max(2.0, 0.7 * ring_px))
    mask = (distance > -inside) & (distance < outside)
    return RimPixels(everything.points[mask], everything.jacobian[mask], everything.grey[mask])


def _rim(view: View, patch: PlanePatch, fit: RimFit, nominal: float, distance_m: float) -> Rim:
    shape = fit.shape
    step = 0.5 * plane_units_per_px(patch)
    probe = shape.centre + step * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    point, *sides = plane_to_px(view.camera, patch, probe)
    jacobian = np.column_stack([sides[0] - sides[1], sides[2] - sides[3]]) / (2.0 * step)
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = shape.centre + shape.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return Rim(
        point_px=point,
        covariance_px2=jacobian @ fit.covariance[:2, :2] @ jacobian.T + np.eye(2) * _FLOOR_PX**2,
        ellipse=ellipse_from_points(plane_to_px(view.camera, patch, circle)),
        size_ratio=shape.radius / nominal,
        size_sigma=float(np.sqrt(fit.covariance[2, 2])) / nominal,
        contrast_grey=fit.contrast_grey,
        residual_grey=fit.residual_grey,
        blur_px=shape.blur_px,
        wall_depth_m=None if shape.wall_ratio is None else shape.wall_ratio * distance_m,
    )
