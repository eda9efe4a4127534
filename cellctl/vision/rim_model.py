"""What a rim looks like: grey values as a function of geometry, blur and light.

Three surfaces meet at a hole: the plate outside the rim, the visible part of the wall between the
rim and the hole's lower edge, and the dark inside. In coordinates of the rim's plane the rim is a
circle, and the lower edge, depth h below a plane at distance D, is the same circle scaled by
1/(1 + h/D) towards the foot of the camera. Both edges are blurred by one Gaussian.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from cellctl.geometry.pose import Array

_SQRT_2PI = float(np.sqrt(2.0 * np.pi))


@dataclass(frozen=True, slots=True)
class RimPixels:
    """The pixels of a fit, flattened."""

    points: Array
    """Shape (n, 2): in the rim's plane, in units of its distance."""
    jacobian: Array
    """Shape (n, 2, 2): derivative of ``points`` by the pixel."""
    grey: Array
    """Shape (n,)."""


@dataclass(frozen=True, slots=True)
class RimShape:
    """The geometry of a rim in its plane, in units of the plane's distance."""

    centre: Array
    """Shape (2,)."""
    radius: float
    blur_px: float
    wall_ratio: float | None = None
    """Depth of the visible wall over the plane's distance; None when no wall is modelled."""

    @property
    def vector(self) -> Array:
        """Centre, radius, blur and, if modelled, wall ratio."""
        wall = [] if self.wall_ratio is None else [self.wall_ratio]
        return np.array([*self.centre, self.radius, self.blur_px, *wall])

    @classmethod
    def from_vector(cls, vector: Array) -> "RimShape":
        """Inverse of ``vector``."""
        wall = float(vector[4]) if len(vector) > 4 else None
        return cls(np.array(vector[:2]), float(vector[2]), float(vector[3]), wall)


def rim_distance_px(points: Array, jacobian: Array, centre: Array, radius: float) -> Array:
    """Signed distance of pixels from a circle of the plane, positive outside, shape (n,)."""
    distance, _, _ = _distance(points, jacobian, centre, radius)
    return distance


def _distance(
    points: Array, jacobian: Array, centre: Array, radius: float
) -> tuple[Array, Array, Array]:
    """Signed distance (px), the radial unit vector in the plane, plane units per px along it."""
    offset = points - centre
    length = np.hypot(offset[..., 0], offset[..., 1])
    unit = offset / np.maximum(length, 1e-12)[..., None]
    gradient = np.einsum("...ij,...i->...j", jacobian, unit)
    scale = np.hypot(gradient[..., 0], gradient[..., 1])
    return (length - radius) / scale, unit, scale


@dataclass(frozen=True, slots=True)
class RimImage:
    """Blurred coverage of the three surfaces and its derivatives by the shape."""

    outside: Array
    """Share of the plate in each pixel, shape (n,)."""
    not_dark: Array
    """Share of plate and wall together, shape (n,)."""
    outside_by_shape: Array
    """Shape (n, p)."""
    not_dark_by_shape: Array
    """Shape (n, p)."""


def rim_image(pixels: RimPixels, shape: RimShape) -> RimImage:
    """Coverage of each pixel by plate, and by plate and wall, for one shape."""
    columns = 4 if shape.wall_ratio is None else 5
    top, unit, scale = _distance(pixels.points, pixels.jacobian, shape.centre, shape.radius)
    by_top = np.zeros((len(top), columns))
    by_top[:, :2] = -unit / scale[:, None]
    by_top[:, 2] = -1.0 / scale
    # A blurred disc of radius r shows its half level nearer to its centre by blur²/(2 r).
    bend_px = 0.5 * shape.blur_px**2 * float(np.mean(scale)) / shape.radius
    top = top + bend_px
    outside, outside_by_shape = _blurred_step(top, by_top, shape.blur_px)
    if shape.wall_ratio is None:
        return RimImage(outside, outside, outside_by_shape, outside_by_shape)
    shrink = 1.0 + shape.wall_ratio
    low_centre, low_radius = shape.centre / shrink, shape.radius / shrink
    low, low_unit, low_scale = _distance(pixels.points, pixels.jacobian, low_centre, low_radius)
    low = low + bend_px
    by_low = np.zeros_like(by_top)
    by_low[:, :2] = -low_unit / (low_scale * shrink)[:, None]
    by_low[:, 2] = -1.0 / (low_scale * shrink)
    by_low[:, 4] = (low_unit @ shape.centre + shape.radius) / (low_scale * shrink**2)
    wall_seen = low > top
    edge = np.where(wall_seen, low, top)
    by_edge = np.where(wall_seen[:, None], by_low, by_top)
    not_dark, not_dark_by_shape = _blurred_step(edge, by_edge, shape.blur_px)
    return RimImage(outside, not_dark, outside_by_shape, not_dark_by_shape)


def _blurred_step(distance_px: Array, by_shape: Array, blur_px: float) -> tuple[Array, Array]:
    """Normal distribution function of the distance and its derivatives by the shape."""
    z = distance_px / blur_px
    density = np.exp(-0.5 * z * z) / (_SQRT_2PI * blur_px)
    derivative = by_shape * density[:, None]
    derivative[:, 3] = -z * density
    return ndtr(z), derivative
