"""Fine fit of a pin's tip: its picture as a flat, a chamfer and the ground round them.

Under a lamp that is brighter on one side the chamfer is bright there and dark opposite. Seen
through a blur of one or two pixels its steepest edge then lies nearer to the middle on the dark
side, which moves a circle through edges towards the lamp by several micrometres. Here the
brightness of flat and chamfer is free in every direction (constant, first and second harmonic), and
only the places of their borders are common: what light does is no longer taken for geometry.

A domed tip, whose brightness changes evenly, is described by the same terms well enough.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.vision.contact_fit.circle_fit import Circle
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

_REACH = 1.55
"""Half side of the pixels that are used, of the radius: not as far as the next contact."""
_ROUNDS = 8
"""Most rounds of the fit."""
_HUBER = 2.0
"""Residual, in standard deviations of a pixel, beyond which a pixel weighs less, as those of dirt
do."""
_BLUR_PX = 1.0
_BLUR_SIGMA = 0.7
"""Blur that is expected, and its standard deviation, px."""
_RADIUS_SIGMA = 0.04
"""Relative standard deviation of the radius that the edges have shown, as between the contacts of
one image (``vision.pattern``)."""
_STEPS: Array = np.array([0.02, 0.02, 0.02, 0.02])
"""Steps of the numerical derivatives by the shape, px."""
_SHAPE = 4
"""Parameters of the shape, in px: x, y, radius, blur. Brightness follows linearly."""
_PIXEL_SIGMA = 0.29
"""Standard deviation of an even spread over the width of a pixel, 1 / sqrt(12)."""
_LEAST_BLUR_PX, _MOST_BLUR_PX = 0.35, 5.0
"""Bounds of the blur. The pixel alone blurs by 0.29 px."""


@dataclass(frozen=True, slots=True, eq=False)
class _Pixels:
    """Pixels round one tip; places in px of the plane from the start of the fit."""

    x: Array
    y: Array
    grey: Array
    flat_radius: float
    """Radius of the flat over that of the tip."""
    flat_shift: Array
    """The flat is nearer to the camera than the rim, and so appears shifted against it, px."""
    root_shift: Array
    """The same of the pin's root, which lies far behind: between both its wall is seen."""


def fit_tip(
    image: Image,
    plane: MeasuringPlane,
    start: Circle,
    *,
    flat_radius: float,
    depth_m: float,
    length_m: float,
) -> Circle | None:
    """Improve a circle that was found by edges; None where the model does not fit.

    ``plane`` is that of the rim, ``depth_m`` below the flat; the radius of the flat is
    ``flat_radius`` of the rim's; the pin stands ``length_m`` out of its ground.
    """
    px_m = plane.m_per_px(start.centre_m)
    radius = start.radius_m / px_m
    pixels = _pixels(
        image,
        plane,
        start,
        px_m=px_m,
        flat_radius=flat_radius,
        heights_m=(depth_m, -length_m),
    )
    if pixels is None:
        return None
    shape = np.array([0.0, 0.0, radius, _BLUR_PX])
    prior = np.array([0.0, 0.0, 1.0 / (_RADIUS_SIGMA * radius), 1.0 / _BLUR_SIGMA])
    weight = np.ones(len(pixels.grey))
    for _ in range(_ROUNDS):
        step, covariance, weight = _step(pixels, shape, radius, prior, weight)
        shape = shape + np.clip(step, -0.5, 0.5)
        shape[3] = np.clip(shape[3], _LEAST_BLUR_PX, _MOST_BLUR_PX)
        if np.hypot(shape[0], shape[1]) > 0.5 * radius:
            return None
        if np.abs(step[:2]).max() < 1e-4:
            break
    return Circle(
        centre_m=start.centre_m + shape[:2] * px_m,
        radius_m=float(shape[2]) * px_m,
        covariance_m2=covariance[:2, :2] * px_m**2,
        support=start.support,
        scatter_m=start.scatter_m,
        slope_grey=start.slope_grey,
    )


def _pixels(
    image: Image,
    plane: MeasuringPlane,
    start: Circle,
    *,
    px_m: float,
    flat_radius: float,
    heights_m: tuple[float, float],
) -> _Pixels | None:
    reach_m = _REACH * start.radius_m
    corners = start.centre_m + reach_m * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    seen = plane.to_px(corners)
    low, high = np.floor(seen.min(axis=0)).astype(int), np.ceil(seen.max(axis=0)).astype(int) + 1
    height, width = image.shape
    if low.min() < 0 or high[0] > width or high[1] > height:
        return None
    rows, columns = np.mgrid[low[1] : high[1], low[0] : high[0]]
    places = plane.from_px(np.column_stack([columns.ravel(), rows.ravel()]).astype(float))
    places = (places - start.centre_m) / px_m
    grey = image[low[1] : high[1], low[0] : high[0]].ravel().astype(float)
    inside = np.hypot(places[:, 0], places[:, 1]) < reach_m / px_m
    shifts = [
        (plane.from_px(plane.at_height(height_m).to_px(start.centre_m[None]))[0] - start.centre_m)
        / px_m
        for height_m in heights_m
    ]
    return _Pixels(
        places[inside, 0], places[inside, 1], grey[inside], flat_radius, shifts[0], shifts[1]
    )


def _step(
    pixels: _Pixels, shape: Array, radius: float, prior: Array, weight: Array
) -> tuple[Array, Array, Array]:
    """One Gauss-Newton step of shape and brightness together.

    Returns the step of the shape, its covariance (4, 4), and the weights of the pixels for the
    next round.
    """
    basis = _basis(pixels, shape)
    root = np.sqrt(weight)
    level = np.linalg.lstsq(basis * root[:, None], pixels.grey * root, rcond=None)[0]
    rest = pixels.grey - basis @ level
    scatter = max(1.4826 * float(np.median(np.abs(rest))), 0.3)
    weight = np.minimum(1.0, _HUBER * scatter / np.maximum(np.abs(rest), 1e-9))
    slopes = [
        (_basis(pixels, shape + change) @ level - basis @ level) / step
        for change, step in zip(np.diag(_STEPS), _STEPS, strict=True)
    ]
    design = np.column_stack([*slopes, basis])
    weighted = design * (weight / scatter**2)[:, None]
    normal = weighted.T @ design
    right = weighted.T @ rest
    pull = np.array([0.0, 0.0, radius - shape[2], _BLUR_PX - shape[3]])
    normal[:_SHAPE, :_SHAPE] += np.diag(prior**2)
    right[:_SHAPE] += prior**2 * pull
    # Terms without a pixel of their own (no ground beside the tip) must not stop the fit.
    normal += 1e-9 * np.diag(np.diag(normal) + 1e-9)
    inverse = np.linalg.inv(normal)
    return (inverse @ right)[:_SHAPE], inverse[:_SHAPE, :_SHAPE], weight


def _basis(pixels: _Pixels, shape: Array) -> Array:
    """Brightness of each surface at every pixel for the level one, shape (pixels, 12)."""
    x, y = pixels.x - shape[0], pixels.y - shape[1]
    distance = np.hypot(x, y)
    # A pixel averages over its own width, which blurs the picture once more.
    blur = np.hypot(shape[3], _PIXEL_SIGMA)
    tip = _inside(shape[2] - distance, blur)
    flat_x, flat_y = x - pixels.flat_shift[0], y - pixels.flat_shift[1]
    flat = _inside(pixels.flat_radius * shape[2] - np.hypot(flat_x, flat_y), blur)
    ring = np.maximum(tip - flat, 0.0)
    safe = np.maximum(distance, 1e-6)
    c, s = x / safe, y / safe
    wall = np.maximum(_inside(shape[2] - _from_line(x, y, pixels.root_shift), blur) - tip, 0.0)
    ones = np.ones_like(x)
    scale = 1.0 / shape[2]
    return np.column_stack(
        [
            *(ring * term for term in (ones, c, s, c * c - s * s, 2.0 * c * s)),
            *(flat * term for term in (ones, x * scale, y * scale)),
            wall,
            *((1.0 - tip - wall) * term for term in (ones, x * scale, y * scale)),
        ]
    )


def _from_line(x: Array, y: Array, end: Array) -> Array:
    """Distance from the straight line between the origin and ``end``."""
    along = (x * end[0] + y * end[1]) / max(float(end @ end), 1e-12)
    part = np.clip(along, 0.0, 1.0)
    return np.asarray(np.hypot(x - part * end[0], y - part * end[1]))


def _inside(distance: Array, blur: float) -> Array:
    """Share of light from inside a border at this distance, positive inside."""
    return np.asarray(0.5 * (1.0 + erf(distance / (np.sqrt(2.0) * blur))))
