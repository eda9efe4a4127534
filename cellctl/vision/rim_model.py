"""What a rim looks like: where its edges lie in the image, and how each depends on the shape.

Up to four surfaces meet at a hole: the plate, the ring of a chamfer, the visible part of the wall,
and the dark inside. Their borders are circles in coordinates of the rim's plane: the outer edge of
the ring, the rim, and the lower edge of the wall, which lies h below a plane at distance D and is
therefore the rim scaled by 1/(1 + h/D) towards the foot of the camera. One Gaussian blurs all.
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

    @property
    def unit_px(self) -> float:
        """Plane units in a pixel."""
        return float(np.sqrt(np.abs(np.mean(np.linalg.det(self.jacobian)))))


@dataclass(frozen=True, slots=True)
class RimShape:
    """The geometry of a rim in its plane, in units of the plane's distance."""

    centre: Array
    """Shape (2,)."""
    radius: float
    blur_px: float
    wall_ratio: float | None = None
    """Depth of the visible wall over the plane's distance; None when no wall is modelled."""
    ring_ratio: float | None = None
    """Outer radius of a ring round the rim over the rim's; None when no ring is modelled."""

    @property
    def vector(self) -> Array:
        """Centre, radius, blur and, where modelled, wall ratio and ring ratio."""
        optional = [value for value in (self.wall_ratio, self.ring_ratio) if value is not None]
        return np.array([*self.centre, self.radius, self.blur_px, *optional])

    def with_vector(self, vector: Array) -> "RimShape":
        """The same model with other numbers."""
        rest = [float(value) for value in vector[4:]]
        wall = None if self.wall_ratio is None else rest.pop(0)
        ring = None if self.ring_ratio is None else rest.pop(0)
        return RimShape(np.array(vector[:2]), float(vector[2]), float(vector[3]), wall, ring)


@dataclass(frozen=True, slots=True)
class Border:
    """One blurred border: how much of each pixel lies outside of it."""

    outside: Array
    """Shape (n,), 0 to 1."""
    by_shape: Array
    """Derivatives by ``RimShape.vector``, shape (n, p)."""
    by_pixel: Array
    """Derivatives by the pixel's column and row, shape (n, 2)."""


@dataclass(frozen=True, slots=True)
class _Circle:
    """Signed distance of pixels from a circle, positive outside."""

    distance_px: Array
    by_shape: Array
    direction: Array
    """Unit vector of growing distance in the image, shape (n, 2)."""
    unit: Array
    """Unit vector of growing distance in the plane, shape (n, 2)."""
    scale: Array
    """Plane units per px along that direction."""


def borders(pixels: RimPixels, shape: RimShape) -> list[Border]:
    """Borders between neighbouring surfaces, from the outermost to the innermost."""
    size = len(shape.vector)
    rim = _circle(pixels, shape.centre, shape.radius, size)
    # A blurred disc of radius r shows its half level nearer to its centre by blur²/(2 r).
    bend_px = 0.5 * shape.blur_px**2 * float(np.mean(rim.scale)) / shape.radius
    found = [_blurred(rim, shape.blur_px, bend_px)]
    if shape.ring_ratio is not None:
        ring = _circle(pixels, shape.centre, shape.radius * shape.ring_ratio, size)
        ring.by_shape[:, -1] = ring.by_shape[:, 2] * shape.radius
        ring.by_shape[:, 2] *= shape.ring_ratio
        found.insert(0, _blurred(ring, shape.blur_px, bend_px))
    if shape.wall_ratio is not None:
        low = _lower_edge(pixels, shape, size)
        seen = low.distance_px > rim.distance_px
        inner = _Circle(
            np.where(seen, low.distance_px, rim.distance_px),
            np.where(seen[:, None], low.by_shape, rim.by_shape),
            np.where(seen[:, None], low.direction, rim.direction),
            rim.unit,
            rim.scale,
        )
        found.append(_blurred(inner, shape.blur_px, bend_px))
    return found


def rim_distance_px(pixels: RimPixels, centre: Array, radius: float) -> Array:
    """Signed distance of pixels from a circle of the plane, positive outside."""
    return _circle(pixels, centre, radius, 4).distance_px


def wall_depth(points: Array, shape: RimShape) -> Array:
    """Depth below the rim, in radii, at which the ray of a pixel meets the bore's wall.

    The ray through ``q`` in the plane runs along ``q`` as it goes deeper; 0 outside the rim.
    """
    offset = points - shape.centre
    a = (points**2).sum(axis=1) + 1e-9
    b = (offset * points).sum(axis=1)
    c = np.minimum((offset**2).sum(axis=1) - shape.radius**2, 0.0)
    return np.asarray((-b + np.sqrt(b * b - a * c)) / (a * shape.radius))


def _circle(pixels: RimPixels, centre: Array, radius: float, size: int) -> _Circle:
    offset = pixels.points - centre
    length = np.hypot(offset[:, 0], offset[:, 1])
    unit = offset / np.maximum(length, 1e-12)[:, None]
    gradient = np.einsum("nij,ni->nj", pixels.jacobian, unit)
    scale = np.hypot(gradient[:, 0], gradient[:, 1])
    by_shape = np.zeros((len(length), size))
    by_shape[:, :2] = -unit / scale[:, None]
    by_shape[:, 2] = -1.0 / scale
    return _Circle((length - radius) / scale, by_shape, gradient / scale[:, None], unit, scale)


def _lower_edge(pixels: RimPixels, shape: RimShape, size: int) -> _Circle:
    shrink = 1.0 + (shape.wall_ratio or 0.0)
    low = _circle(pixels, shape.centre / shrink, shape.radius / shrink, size)
    low.by_shape[:, :3] /= shrink
    low.by_shape[:, 4] = (low.unit @ shape.centre + shape.radius) / (low.scale * shrink**2)
    return low


def _blurred(circle: _Circle, blur_px: float, bend_px: float) -> Border:
    z = (circle.distance_px + bend_px) / blur_px
    density = np.exp(-0.5 * z * z) / (_SQRT_2PI * blur_px)
    by_shape = circle.by_shape * density[:, None]
    by_shape[:, 3] = -z * density
    return Border(np.asarray(ndtr(z)), by_shape, circle.direction * density[:, None])
