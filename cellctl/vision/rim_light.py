"""How grey values vary over the surfaces at a rim: few smooth terms for each.

Terms that the grey values of one hole hardly determine carry a prior: a standard deviation of
their amplitude about zero. So what is not known widens the covariance of the centre.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.vision.rim_model import Border, RimPixels, RimShape, wall_depth

_LEAST_SHARE = 1e-5
_FADE = 0.4
"""Light in a bore falls to 1/e at about 1.25 diameters."""
_WALL_OFFSET_GREY, _WALL_FADE_GREY, _THREAD_GREY = 8.0, 4.0, 60.0
_THREAD_BAND = 0.15
"""Radial extent, in radii, over which the flanks of a thread change by about their contrast."""


@dataclass(frozen=True, slots=True)
class Light:
    """Which terms are free beside the mean levels and an even gradient on the plate."""

    cone: bool = False
    """Outside the rim lies a cone, whose grey varies with the azimuth, not with x and y."""
    thread: bool = False
    """Inside the rim lie the turns of a thread, not an even dark."""


@dataclass(frozen=True, slots=True)
class Surface:
    """One surface: where it is seen, and the terms of its grey."""

    outer: int | None
    """Index of the border at which it begins; None for the outermost surface."""
    inner: int | None
    """Index of the border at which it ends; None for the innermost surface."""
    columns: Array
    """Shape (n, terms)."""
    sigma_grey: Array
    """Prior standard deviation of each term's amplitude, shape (terms,); infinite when free."""

    def share(self, borders: Sequence[Border]) -> Array:
        """Part of each pixel that it covers, shape (n,)."""
        inner = 1.0 if self.inner is None else borders[self.inner].outside
        return np.asarray(inner - (0.0 if self.outer is None else borders[self.outer].outside))


def surfaces(
    pixels: RimPixels, shape: RimShape, edges: Sequence[Border], light: Light
) -> list[Surface]:
    """The surfaces at a rim; the wall is what it adds to the dark inside.

    A pixel collects light from its surroundings. Where a surface covers only part of them, its
    grey is that at the middle of this part: blur² times the gradient of the coverage, over the
    coverage, away from the pixel. Exact for a grey that changes linearly.
    """
    rim = 0 if shape.ring_ratio is None else 1

    def points(outer: int | None, inner: int | None) -> Array:
        return _middle(pixels, shape, edges, outer, inner)

    found = [Surface(None, 0, *_plate(points(None, 0), shape, light))]
    if shape.ring_ratio is not None:
        found.append(Surface(0, rim, *_free(_around(points(0, rim), shape))))
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
    """Middle of what each pixel collects of a surface, shape (n, 2)."""
    share = np.ones_like(pixels.grey) if inner is None else edges[inner].outside
    slope = np.zeros_like(pixels.points) if inner is None else edges[inner].by_pixel
    if outer is not None:
        share, slope = share - edges[outer].outside, slope - edges[outer].by_pixel
    shift_px = shape.blur_px**2 * slope / np.maximum(share, _LEAST_SHARE)[:, None]
    length = np.hypot(shift_px[:, 0], shift_px[:, 1])
    shift_px *= np.minimum(1.0, 3.0 * shape.blur_px / np.maximum(length, 1e-9))[:, None]
    return np.asarray(pixels.points + (pixels.jacobian @ shift_px[:, :, None])[:, :, 0])


def _free(columns: Array) -> tuple[Array, Array]:
    return columns, np.full(columns.shape[1], np.inf)


def _polar(points: Array, shape: RimShape) -> tuple[Array, Array, Array]:
    """Radius over the rim's, cosine and sine of the azimuth."""
    x, y = ((points - shape.centre) / shape.radius).T
    radius = np.maximum(np.hypot(x, y), 1e-6)
    return radius, x / radius, y / radius


def _around(points: Array, shape: RimShape) -> Array:
    _, cos, sin = _polar(points, shape)
    return np.column_stack([np.ones_like(cos), cos, sin, cos * cos - sin * sin, 2.0 * sin * cos])


def _linear(points: Array, shape: RimShape) -> Array:
    radius, cos, sin = _polar(points, shape)
    above = radius - 1.0
    return np.column_stack([above, above * cos, above * sin])


def _plate(points: Array, shape: RimShape, light: Light) -> tuple[Array, Array]:
    if light.cone:
        return _free(np.hstack([_around(points, shape), _linear(points, shape)]))
    return _free(np.column_stack([np.ones(len(points)), (points - shape.centre) / shape.radius]))


def _wall(points: Array, shape: RimShape) -> tuple[Array, Array]:
    depth = wall_depth(points, shape)
    met = (points - shape.centre) / shape.radius + depth[:, None] * points
    length = np.maximum(np.hypot(met[:, 0], met[:, 1]), 1e-9)
    fade = np.exp(-_FADE * depth)
    columns = np.column_stack(
        [fade, fade * met[:, 0] / length, fade * met[:, 1] / length, fade * depth, 1.0 - fade]
    )
    return columns, np.array([np.inf, np.inf, np.inf, _WALL_FADE_GREY, _WALL_OFFSET_GREY])


def _inside(points: Array, shape: RimShape, light: Light) -> tuple[Array, Array]:
    if light.thread:
        columns = np.hstack([_around(points, shape)[:, :3], _linear(points, shape) / _THREAD_BAND])
        return columns, np.array([np.inf, *[_THREAD_GREY] * 5])
    return _free(np.ones((len(points), 1)))
