"""The rim of one hole in one image or in both: where its centre projects to, and how surely."""

from dataclasses import dataclass

import cv2
import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera import PlanePatch, plane_basis, plane_patch, project
from cellctl.vision.ellipse import Ellipse, ellipse_from_points
from cellctl.vision.features import Hole
from cellctl.vision.rim_edges import EdgeCircle, edge_circle, plane_to_px
from cellctl.vision.rim_fit import RimFit, RingPrior, fit_rim, fit_rim_pair, rim_cost
from cellctl.vision.rim_light import Light
from cellctl.vision.rim_model import RimPixels, RimShape, rim_distance_px
from cellctl.vision.stereo_head import CameraModel

_RADIUS_TOLERANCE = 0.07
_MIN_SUPPORT = 0.55
_MIN_CONTRAST_GREY = 8.0
_MAX_MOVE_PX = 2.5
_BAND_INSIDE_PX, _THREAD_INSIDE_PX, _BAND_OUTSIDE_PX = 6.5, 3.0, 5.5
_WALL_DEPTHS_M = (0.8e-3, 2.5e-3, 8e-3)
_BIC_EVIDENCE = 12.0
_CLEAR_EVIDENCE = 150.0
_CHAMFER_RATIO, _CHAMFER_SIGMA = 1.1, 0.05
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
class _Found:
    """A rim located by its edges."""

    sight: Sight
    hole: Hole
    patch: PlanePatch
    grey: Array
    circle: EdgeCircle

    @property
    def nominal(self) -> float:
        """Nominal radius in plane units."""
        return self.hole.diameter_m / 2.0 / self.sight.distance_m


def coarse_rim(sight: Sight, hole: Hole, reach_px: float) -> Array | Rejection:
    """Raw pixel of the centre from edge points alone; good to a fraction of a pixel."""
    found = _locate(sight, hole, reach_px)
    if isinstance(found, Rejection):
        return found
    return plane_to_px(sight.camera, found.patch, found.circle.centre[None])[0]


def measure_rim(sight: Sight, hole: Hole, reach_px: float) -> Rim | Rejection:
    """Measure a rim in one image, its place known to ``reach_px`` and its plane to a degree."""
    found = _locate(sight, hole, reach_px)
    if isinstance(found, Rejection):
        return found
    fit = _fit_alone(found)
    refusal = _refusal(found, fit, fit.shapes[0])
    return refusal or _rim(found, fit, fit.shapes[0], fit.covariance[:2, :2])


def measure_thread(
    sights: tuple[Sight, Sight],
    hole: Hole,
    reach_px: float,
    blur_px: tuple[float, float] | None,
) -> tuple[Rim, Rim, Array] | Rejection:
    """Measure the rim of a thread and its chamfer in both images at once.

    ``blur_px`` is the blur of other rims in these images, where there are any. Third of the result
    is the joint covariance of both points, shape (4, 4), px².
    """
    located = []
    for sight in sights:
        found = _locate(sight, hole, reach_px)
        if isinstance(found, Rejection):
            return found
        located.append(found)
    left, right = located
    blurs, blur_sigma = ((_BLUR_PX, _BLUR_PX), _BLUR_SIGMA_PX)
    if blur_px is not None:
        blurs, blur_sigma = blur_px, _KNOWN_BLUR_SIGMA_PX
    starts = tuple(
        RimShape(found.circle.centre, found.nominal, blur, None, _CHAMFER_RATIO)
        for found, blur in zip(located, blurs, strict=True)
    )
    fit = fit_rim_pair(
        (_band(left), _band(right)),
        (starts[0], starts[1]),
        Light(thread=True),
        RingPrior(_DIAMETER_SIGMA, _CHAMFER_RATIO, _CHAMFER_SIGMA, blur_sigma),
    )
    for found, shape in zip(located, fit.shapes, strict=True):
        refusal = _refusal(found, fit, shape)
        if refusal is not None:
            return refusal
    jacobian = np.zeros((4, 4))
    jacobian[:2, :2] = _px_by_plane(left, fit.shapes[0])
    jacobian[2:, 2:] = _px_by_plane(right, fit.shapes[1])
    joint = jacobian @ fit.covariance[:4, :4] @ jacobian.T + np.eye(4) * _FLOOR_PX**2
    rims = [
        _rim(found, fit, fit.shapes[index], fit.covariance[part, part])
        for index, (found, part) in enumerate(zip(located, (slice(2), slice(2, 4)), strict=True))
    ]
    return rims[0], rims[1], joint


def _locate(sight: Sight, hole: Hole, reach_px: float) -> _Found | Rejection:
    cut = _cut(sight, hole, reach_px)
    if cut is None:
        return Rejection("lies outside the image")
    patch, grey = cut
    circle = edge_circle(
        np.asarray(cv2.GaussianBlur(grey, (0, 0), 1.0), dtype=float),
        patch,
        sight.camera,
        patch.basis @ sight.centre_m / sight.distance_m,
        hole.diameter_m / 2.0 / sight.distance_m,
        reach_px=reach_px,
        radius_tolerance=_RADIUS_TOLERANCE,
        bright=hole.kind == "disc",
    )
    if circle is None:
        return Rejection("no round edge of the nominal size")
    if circle.support < _MIN_SUPPORT:
        return Rejection(f"only {circle.support:.0%} of the rim has an edge")
    return _Found(sight, hole, patch, grey, circle)


def _cut(sight: Sight, hole: Hole, reach_px: float) -> tuple[PlanePatch, Array] | None:
    middle = project(sight.camera, sight.centre_m[None])[0]
    focal = float(sight.camera.camera_matrix[0, 0])
    radius_px = focal * hole.diameter_m / 2.0 / float(sight.centre_m[2])
    half = int(np.ceil(radius_px * (1.0 + _RADIUS_TOLERANCE) + reach_px + _BAND_OUTSIDE_PX + 2.0))
    x0, y0 = (int(value) - half for value in np.rint(middle))
    size = 2 * half + 1
    height, width = sight.image.shape
    if x0 < 0 or y0 < 0 or x0 + size > width or y0 + size > height:
        return None
    grey = sight.image[y0 : y0 + size, x0 : x0 + size].astype(float)
    basis = plane_basis(sight.normal, sight.across)
    return plane_patch(sight.camera, sight.normal, basis, (x0, y0), (size, size)), grey


def _fit_alone(found: _Found) -> RimFit:
    """The simplest model of the rim that the grey values do not contradict."""
    pixels, circle = _band(found), found.circle
    light = Light(cone=found.hole.countersink_m is not None)
    bare = RimShape(circle.centre, circle.radius, _BLUR_PX)
    if found.hole.kind == "disc":
        return fit_rim(pixels, bare, light)
    depths = [depth / found.sight.distance_m for depth in _WALL_DEPTHS_M]
    walls = [RimShape(circle.centre, circle.radius, _BLUR_PX, depth) for depth in depths]
    costs = [rim_cost(pixels, wall, light) for wall in walls]
    best = walls[int(np.argmin(costs))]
    walled = None
    if min(costs) < rim_cost(pixels, bare, light) - _CLEAR_EVIDENCE:
        walled = fit_rim(pixels, best, light)
        if walled.converged:
            return walled
    plain = fit_rim(pixels, bare, light)
    centre, radius = plain.shapes[0].centre, plain.shapes[0].radius
    again = [RimShape(centre, radius, plain.shapes[0].blur_px, depth) for depth in depths]
    costs = [rim_cost(pixels, wall, light) for wall in again]
    if min(costs) > rim_cost(pixels, plain.shapes[0], light) - _BIC_EVIDENCE:
        return plain
    walled = fit_rim(pixels, again[int(np.argmin(costs))], light)
    return walled if walled.converged and walled.bic < plain.bic - _BIC_EVIDENCE else plain


def _band(found: _Found) -> RimPixels:
    """The pixels near the rim that the model describes."""
    patch, circle, hole = found.patch, found.circle, found.hole
    everything = RimPixels(patch.points, patch.jacobian, found.grey.ravel(), patch.unit_px)
    distance = rim_distance_px(everything, circle.centre, circle.radius)
    radius_px = circle.radius / patch.unit_px
    inside, outside = min(_BAND_INSIDE_PX, 0.5 * radius_px), _BAND_OUTSIDE_PX
    if hole.kind == "thread":
        inside = _THREAD_INSIDE_PX
    elif hole.countersink_m is not None:
        ring_px = radius_px * (hole.countersink_m / hole.diameter_m - 1.0)
        outside = min(outside, max(2.0, 0.7 * ring_px))
    mask = (distance > -inside) & (distance < outside)
    return RimPixels(
        np.ascontiguousarray(patch.points[:, mask]),
        np.ascontiguousarray(patch.jacobian[:, :, mask]),
        everything.grey[mask],
        patch.unit_px,
    )


def _refusal(found: _Found, fit: RimFit, shape: RimShape) -> Rejection | None:
    moved_px = float(np.linalg.norm(shape.centre - found.circle.centre)) / found.patch.unit_px
    if not fit.converged:
        return Rejection("fit of the rim did not settle")
    if abs(fit.contrast_grey) < _MIN_CONTRAST_GREY:
        return Rejection("too little contrast at the rim")
    if moved_px > _MAX_MOVE_PX or abs(shape.radius / found.nominal - 1.0) > _RADIUS_TOLERANCE:
        return Rejection("fitted rim does not have the nominal size and place")
    return None


def _px_by_plane(found: _Found, shape: RimShape) -> Array:
    """Derivative of the raw pixel by the plane's coordinates at the centre, shape (2, 2)."""
    step = 0.5 * found.patch.unit_px
    probe = shape.centre + step * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    sides = plane_to_px(found.sight.camera, found.patch, probe)
    return np.column_stack([sides[0] - sides[1], sides[2] - sides[3]]) / (2.0 * step)


def _rim(found: _Found, fit: RimFit, shape: RimShape, covariance: Array) -> Rim:
    camera, patch = found.sight.camera, found.patch
    jacobian = _px_by_plane(found, shape)
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = shape.centre + shape.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    wall = shape.wall_ratio
    return Rim(
        point_px=plane_to_px(camera, patch, shape.centre[None])[0],
        covariance_px2=jacobian @ covariance @ jacobian.T + np.eye(2) * _FLOOR_PX**2,
        ellipse=ellipse_from_points(plane_to_px(camera, patch, circle)),
        size_ratio=shape.radius / found.nominal,
        residual_grey=fit.residual_grey,
        blur_px=shape.blur_px,
        wall_depth_m=None if wall is None else wall * found.sight.distance_m,
    )
