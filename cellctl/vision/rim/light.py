"""The light model: a few smooth terms for the grey values of each surface at a rim.

Terms that the grey values of one hole hardly determine carry a prior: a standard deviation of
their amplitude about zero. What is not known thus widens the covariance of the centre instead of
shifting the centre.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim.shape import Border, RimPixels, RimShape, wall_depth

_LEAST_SHARE = 1e-5
"""Coverage below which a pixel counts as collecting nothing of a surface; keeps the quotient in
``_middle`` finite."""
_FADE = 0.4
"""Decay of the light on a wall with depth, 1/radii: it falls to 1/e at about 1.25 diameters."""
_WALL_GREY = 40.0
"""Standard deviation of the light of a wall about an even fade at that rate."""
_THREAD_BAND = 0.15
"""Radial extent, in radii, over which the flanks of a thread change by about their contrast."""


@dataclass(frozen=True, slots=True)
class LightModel:
    """Which terms are free beside the mean levels and an even gradient on the plate."""

    cone: bool = False
    """Outside the rim lies a cone, whose grey varies with the azimuth, not with x and y."""
    uneven_grey: float = 0.0
    """How uneven what is seen inside the rim is, such as the turns of a thread: standard deviation
    of each term; 0 for an even dark."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """One surface: where it is seen, and the terms of its grey."""

    outer: int | None
    """Index of the border at which it begins; None for the outermost surface."""
    inner: int | None
    """Index of the border at which it ends; None for the innermost surface."""
    terms: Array
    """Shape (terms, n)."""
    sigma_grey: Array
    """Prior standard deviation of each term's amplitude, shape (terms,); infinite when free."""
    ring: bool = False
    """It is the ring, whose grey several cameras see alike."""

    def share(self, edges: Sequence[Border]) -> Array:
        """Part of each pixel that it covers, shape (n,)."""
        inner = 1.0 if self.inner is None else edges[self.inner].outside
        return np.asarray(inner - (0.0 if self.outer is None else edges[self.outer].outside))

    def by_shape(self, edges: Sequence[Border], amplitudes: Array) -> Array:
        """Derivative of its contribution by the shape, shape (p, n)."""
        inner = 0.0 if self.inner is None else edges[self.inner].by_shape
        outer = 0.0 if self.outer is None else edges[self.outer].by_shape
        return np.asarray((amplitudes @ self.terms) * (inner - outer))


def surfaces(
    pixels: RimPixels, shape: RimShape, edges: Sequence[Border], light: LightModel
) -> list[Surface]:
    """The surfaces at a rim, from the outermost to the innermost.

    The wall stands for what it adds to the dark inside, whose own terms reach up to the rim.
    """
    rim = 0 if shape.ring_ratio is None else 1

    def points(outer: int | None, inner: int | None) -> Array:
        return _middle(pixels, shape, edges, outer, inner)

    found = [Surface(None, 0, *_plate(points(None, 0), shape, light))]
    if shape.ring_ratio is not None:
        terms, sigma = _free(_around(points(0, rim), shape))
        found.append(Surface(0, rim, terms, sigma, ring=True))
    if shape.wall_ratio is not None:
        found.append(Surface(rim, rim + 1, *_wall(points(rim, rim + 1), shape)))
    found.append(Surface(rim, None, *_inside(points(rim, None), shape, light)))
    return found


def _middle(
    pixels: RimPixels,
    shape: RimShape,
    edges: Sequence[Border],
    outer: int | None,
    inner: int | None,
) -> Array:
    """Middle of what each pixel collects of a surface, shape (2, n).

    A pixel collects light from its surroundings. Where a surface covers only part of them, its grey
    is that at the middle of this part: blur² times the gradient of the coverage, over the coverage,
    away from the pixel. This is exact for a grey that changes linearly.
    """
    share = np.ones_like(pixels.grey) if inner is None else edges[inner].outside
    slope = np.zeros_like(pixels.points) if inner is None else edges[inner].by_pixel
    if outer is not None:
        share, slope = share - edges[outer].outside, slope - edges[outer].by_pixel
    shift_px = slope * (shape.blur_px**2 / np.maximum(share, _LEAST_SHARE))
    length = np.sqrt(shift_px[0] ** 2 + shift_px[1] ** 2)
    # Where the coverage goes to nothing the quotient grows without limit, while the pixel collects
    # nothing from beyond three blurs.
    shift_px *= np.minimum(1.0, 3.0 * shape.blur_px / np.maximum(length, 1e-9))
    by_pixel = pixels.jacobian
    return np.asarray(pixels.points + by_pixel[:, 0] * shift_px[0] + by_pixel[:, 1] * shift_px[1])


def _free(terms: Array) -> tuple[Array, Array]:
    return terms, np.full(len(terms), np.inf)


def _polar(points: Array, shape: RimShape) -> tuple[Array, Array, Array]:
    """Radius over the rim's, cosine and sine of the azimuth."""
    x, y = (points - shape.centre[:, None]) / shape.radius
    radius = np.maximum(np.sqrt(x * x + y * y), 1e-6)
    return radius, x / radius, y / radius


def _around(points: Array, shape: RimShape) -> Array:
    """Harmonics of the azimuth up to the second, shape (5, n)."""
    _, cos, sin = _polar(points, shape)
    return np.stack([np.ones_like(cos), cos, sin, cos * cos - sin * sin, 2.0 * sin * cos])


def _plate(points: Array, shape: RimShape, light: LightModel) -> tuple[Array, Array]:
    if not light.cone:
        flat = (points - shape.centre[:, None]) / shape.radius
        return _free(np.stack([np.ones_like(flat[0]), *flat]))
    around = _around(points, shape)
    above = _polar(points, shape)[0] - 1.0
    return _free(np.concatenate([around, above[None]]))


def _wall(points: Array, shape: RimShape) -> tuple[Array, Array]:
    depth = wall_depth(points, shape)
    met = (points - shape.centre[:, None]) / shape.radius + depth * points
    met /= np.maximum(np.sqrt(met[0] ** 2 + met[1] ** 2), 1e-9)
    fade = np.exp(-_FADE * depth)
    # The rate of the fade is only roughly known and may differ round the bore: these terms let it,
    # held by their prior.
    deep = 1.0 - fade
    around = np.stack([np.ones_like(depth), met[0], met[1]])
    terms = np.concatenate([fade * around, fade * depth * around, deep * around])
    return terms, np.array([*[np.inf] * 3, *[_WALL_GREY] * 6])


def _inside(points: Array, shape: RimShape, light: LightModel) -> tuple[Array, Array]:
    if light.uneven_grey == 0.0:
        # The dark inside of a bore has one level only. Slopes in it would compete with a shift of
        # the rim; where the inside is uneven, a score test asks for a wall instead.
        return _free(np.ones((1, points.shape[1])))
    radius, cos, sin = _polar(points, shape)
    double_cos, double_sin = cos * cos - sin * sin, 2.0 * sin * cos
    triple_cos, triple_sin = (
        cos * double_cos - sin * double_sin,
        sin * double_cos + cos * double_sin,
    )
    level = np.stack([np.ones_like(cos), cos, sin, double_cos, double_sin, triple_cos, triple_sin])
    band = (radius - 1.0) / _THREAD_BAND
    terms = np.concatenate([level, level * band, level[:5] * band**2])
    return terms, np.array([np.inf, *[light.uneven_grey] * (len(terms) - 1)])
