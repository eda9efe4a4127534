"""The geometry of a rim: where its edges lie in the image, and how they move with its parameters.

Up to four surfaces meet at a hole: the plate, the ring of a chamfer, the visible part of the wall,
and the dark inside. Their borders are circles in coordinates of the rim's plane: the outer edge of
the ring, the rim, and the lower edge of the wall. The lower edge lies h below a plane at distance D
and is therefore the rim scaled by 1/(1 + h/D) towards the foot of the camera. One blur lies over
all of them: a Gaussian, unless the image has moved or is out of focus (``spread``).

Arrays hold one pixel a column, because this is the inner loop of every measurement: rows are then
contiguous in memory.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.spread import ImageSpread, edge_density, outside_edge


@dataclass(frozen=True, slots=True, eq=False)
class RimPixels:
    """The pixels of a fit."""

    points: Array
    """Shape (2, n): in the rim's plane, in units of its distance."""
    jacobian: Array
    """Shape (2, 2, n): derivative of ``points`` by the pixel's column and row."""
    grey: Array
    """Shape (n,)."""
    unit_px: float
    """Plane units in a pixel."""
    spread: ImageSpread = field(default_factory=ImageSpread)
    """That of the image."""


@dataclass(frozen=True, slots=True, eq=False)
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
    ring_slope: float = 0.0
    """Rise of the ring over its width: 0 in the plane of the rim, 1 for a chamfer of 90°."""

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
        centre, radius, blur_px = np.array(vector[:2]), float(vector[2]), float(vector[3])
        return RimShape(centre, radius, blur_px, wall, ring, self.ring_slope)


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """One blurred border: how much of each pixel lies outside of it."""

    outside: Array
    """Shape (n,), 0 to 1."""
    by_shape: Array
    """Derivatives by ``RimShape.vector``, shape (p, n)."""
    by_pixel: Array
    """Derivatives by the pixel's column and row, shape (2, n)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Circle:
    """Signed distance of pixels from a circle, positive outside."""

    distance_px: Array
    unit: Array
    """Unit vector of growing distance in the plane, shape (2, n)."""
    direction: Array
    """Unit vector of growing distance in the image, shape (2, n)."""
    px: Array
    """Pixels in a plane unit along that direction, shape (n,)."""


def borders(pixels: RimPixels, shape: RimShape) -> list[Border]:
    """Borders between neighbouring surfaces, from the outermost to the innermost."""
    rim = _circle(pixels, shape.centre, shape.radius)
    by_rim = _by_centre_and_radius(rim, shape)
    found = [_blurred(pixels, shape, rim, by_rim)]
    if shape.ring_ratio is not None:
        found.insert(0, _blurred(pixels, shape, *_outer_circle(pixels, shape)))
    if shape.wall_ratio is not None:
        shrink = 1.0 + shape.wall_ratio
        low = _circle(pixels, shape.centre / shrink, shape.radius / shrink)
        by_low = _by_centre_and_radius(low, shape) / shrink
        by_low[4] = (shape.centre @ low.unit + shape.radius) * low.px / shrink**2
        # The lower edge is hidden wherever it lies outside the rim: there the rim itself ends the
        # wall, which then covers nothing.
        seen = low.distance_px > rim.distance_px
        inner = _Circle(
            np.where(seen, low.distance_px, rim.distance_px),
            rim.unit,
            np.where(seen, low.direction, rim.direction),
            rim.px,
        )
        found.append(_blurred(pixels, shape, inner, np.where(seen, by_low, by_rim)))
    return found


def across_rim(pixels: RimPixels, shape: RimShape) -> tuple[Array, Array]:
    """Unit vectors in the image across the rim, shape (2, n), and distances over the blur (n,)."""
    rim = _circle(pixels, shape.centre, shape.radius)
    return rim.direction, _in_blurs(pixels, shape, rim, rim.distance_px)


def outside_walls(pixels: RimPixels, shape: RimShape, ratios: Sequence[float]) -> Array:
    """Share of each pixel outside the lower edge of a wall, for walls of several depths, (k, n)."""
    rim = _circle(pixels, shape.centre, shape.radius)
    shrink = 1.0 + np.array(ratios)[:, None]
    x, y = pixels.points[:, None] - shape.centre[:, None, None] / shrink
    low_px = (np.sqrt(x * x + y * y) - shape.radius / shrink) * rim.px
    inner_px = np.maximum(low_px, rim.distance_px)
    return outside_edge(_in_blurs(pixels, shape, rim, inner_px), pixels.spread.excess)


def outside_circles(pixels: RimPixels, shape: RimShape, radii: Array) -> Array:
    """Share of each pixel outside circles (k,) round the rim's centre, in its plane, (k, n)."""
    rim = _circle(pixels, shape.centre, shape.radius)
    distances_px = rim.distance_px - (radii - shape.radius)[:, None] * rim.px
    return outside_edge(_in_blurs(pixels, shape, rim, distances_px), pixels.spread.excess)


def wall_depth(points: Array, shape: RimShape) -> Array:
    """Depth below the rim, in radii, at which the ray of a pixel meets the bore's wall.

    The ray through ``q`` in the plane runs along ``q`` as it goes deeper; 0 outside the rim.
    """
    x, y = points
    dx, dy = x - shape.centre[0], y - shape.centre[1]
    a = x * x + y * y + 1e-9
    b = dx * x + dy * y
    # Pixels outside the rim meet no wall: the bound keeps the root real for them.
    c = np.minimum(dx * dx + dy * dy - shape.radius**2, 0.0)
    return np.asarray((-b + np.sqrt(b * b - a * c)) / (a * shape.radius))


def _blur_px(pixels: RimPixels, shape: RimShape, edge: _Circle) -> Array | float:
    """Standard deviation of the blur across an edge."""
    if not pixels.spread.moved:
        return shape.blur_px
    (move_x, move_y), (x, y) = pixels.spread.movement_px, edge.direction
    return np.asarray(np.sqrt(shape.blur_px**2 + (move_x * x + move_y * y) ** 2))


def _bend_px(pixels: RimPixels, shape: RimShape, edge: _Circle) -> Array | float:
    """How far the half level of a blurred disc of radius r lies inside its edge: variance/(2 r).

    Blur along a curved edge takes more light from its outside than from its inside. Without this
    the radius would come out too small.
    """
    (move_x, move_y), (x, y) = pixels.spread.movement_px, edge.direction
    along = move_y * x - move_x * y if pixels.spread.moved else 0.0
    return 0.5 * (shape.blur_px**2 + along * along) * pixels.unit_px / shape.radius


def _in_blurs(pixels: RimPixels, shape: RimShape, edge: _Circle, distances_px: Array) -> Array:
    """Distances from an edge over its blur, shape (..., n); 0 where it looks half as bright."""
    bend_px = _bend_px(pixels, shape, edge)
    return np.asarray((distances_px + bend_px) / _blur_px(pixels, shape, edge))


def _circle(pixels: RimPixels, centre: Array, radius: float) -> _Circle:
    offset = pixels.points - centre[:, None]
    length = np.sqrt(offset[0] ** 2 + offset[1] ** 2)
    unit = offset / np.maximum(length, 1e-12)
    direction = pixels.jacobian[0] * unit[0] + pixels.jacobian[1] * unit[1]
    px = 1.0 / np.sqrt(direction[0] ** 2 + direction[1] ** 2)
    return _Circle((length - radius) * px, unit, direction * px, px)


def _outer_circle(pixels: RimPixels, shape: RimShape) -> tuple[_Circle, Array]:
    """Outer edge of the ring, nearer to the camera than the rim, and its derivatives."""
    ratio, slope = float(shape.ring_ratio or 1.0), shape.ring_slope
    grow = 1.0 - slope * shape.radius * (ratio - 1.0)
    circle = _circle(pixels, shape.centre / grow, shape.radius * ratio / grow)
    derivatives = _by_centre_and_radius(circle, shape) / grow
    by_rise = -(shape.centre @ circle.unit + shape.radius * ratio) * circle.px / grow**2
    derivatives[-1] = derivatives[2] * shape.radius + by_rise * slope * shape.radius
    derivatives[2] = derivatives[2] * ratio + by_rise * slope * (ratio - 1.0)
    return circle, derivatives


def _by_centre_and_radius(circle: _Circle, shape: RimShape) -> Array:
    """Derivatives of the distance by centre and radius; the other rows are zero."""
    derivatives = np.zeros((len(shape.vector), len(circle.px)))
    derivatives[:2] = -circle.unit * circle.px
    derivatives[2] = -circle.px
    return derivatives


def _blurred(pixels: RimPixels, shape: RimShape, circle: _Circle, by_distance: Array) -> Border:
    blur_px, excess = _blur_px(pixels, shape, circle), pixels.spread.excess
    z = np.asarray((circle.distance_px + _bend_px(pixels, shape, circle)) / blur_px)
    density = edge_density(z, excess) / blur_px
    by_shape = by_distance * density
    by_shape[3] = -z * density * (shape.blur_px / blur_px)
    return Border(outside_edge(z, excess), by_shape, circle.direction * density)
