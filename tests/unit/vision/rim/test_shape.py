"""Borders at a rim: their derivatives, and the curvature that blur adds."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.vision.rim.shape import RimPixels, RimShape, borders, outside_walls, wall_depth
from cellctl.vision.rim.spread import ImageSpread

UNIT_PX = 1.0 / 3600.0
RADIUS = 21.5 * UNIT_PX

SHAPES = {
    "bore": RimShape(np.array([0.02, -0.01]), RADIUS, 1.1),
    "wall": RimShape(np.array([0.02, -0.01]), RADIUS, 1.1, wall_ratio=0.006),
    "flat ring": RimShape(np.array([0.02, -0.01]), RADIUS, 1.1, ring_ratio=1.15),
    "cone": RimShape(np.array([0.02, -0.01]), RADIUS, 1.1, ring_ratio=1.15, ring_slope=1.0),
}


def pixels_round(centre: Array) -> RimPixels:
    """Square pixels that look straight at the plane."""
    columns, rows = (axis.ravel() for axis in np.meshgrid(np.arange(-30, 31), np.arange(-30, 31)))
    # The model is made for the band along a rim: no pixel lies on the centre itself.
    points = centre[:, None] + (np.stack([columns, rows]) + 0.3) * UNIT_PX
    jacobian = np.broadcast_to(np.eye(2)[:, :, None] * UNIT_PX, (2, 2, columns.size)).copy()
    return RimPixels(points, jacobian, np.zeros(columns.size), UNIT_PX)


SPREADS = {
    "as the lens has it": ImageSpread(),
    "moved": ImageSpread(np.array([0.5, -0.7])),
    "out of focus": ImageSpread(excess=-0.8),
}


@pytest.mark.parametrize("spread", SPREADS.values(), ids=SPREADS)
@pytest.mark.parametrize("name", SHAPES)
def test_derivatives_of_the_borders_are_those_of_their_values(
    name: str, spread: ImageSpread
) -> None:
    shape = SHAPES[name]
    pixels = replace(pixels_round(shape.centre), spread=spread)
    exact = borders(pixels, shape)
    # The small shift of the half level by blur is taken for constant in the derivatives.
    tolerance = 0.06 * max(float(np.abs(border.by_shape[2]).max()) for border in exact) * UNIT_PX
    for index, step in enumerate([1e-7, 1e-7, 1e-7, 1e-5, 1e-7][: len(shape.vector)]):
        change = np.zeros(len(shape.vector))
        change[index] = step
        above = borders(pixels, shape.with_vector(shape.vector + change))
        below = borders(pixels, shape.with_vector(shape.vector - change))
        scale = UNIT_PX if index != 3 else 1.0
        for border, high, low in zip(exact, above, below, strict=True):
            numeric = (high.outside - low.outside) / (2.0 * step)
            assert np.abs(numeric - border.by_shape[index]).max() * scale < tolerance


@pytest.mark.parametrize("spread", SPREADS.values(), ids=SPREADS)
def test_the_outside_of_a_disc_is_what_a_blurred_disc_leaves(spread: ImageSpread) -> None:
    """Light that a spread moves about is not lost."""
    shape = SHAPES["bore"]
    (rim,) = borders(replace(pixels_round(shape.centre), spread=spread), shape)
    area_px2 = float(np.sum(1.0 - rim.outside))
    assert area_px2 == pytest.approx(np.pi * 21.5**2, rel=2e-4)


def test_a_deeper_wall_leaves_less_of_the_dark() -> None:
    shape = SHAPES["bore"]
    seen = outside_walls(pixels_round(shape.centre), shape, [0.002, 0.004, 0.008])
    assert (np.diff(seen.sum(axis=1)) > 0.0).all()
    (rim,) = borders(pixels_round(shape.centre), shape)
    assert (seen >= rim.outside - 1e-12).all()


def test_a_ray_meets_the_wall_on_the_circle_below_the_rim() -> None:
    shape = SHAPES["bore"]
    pixels = pixels_round(shape.centre)
    depth = wall_depth(pixels.points, shape)
    met = (pixels.points - shape.centre[:, None]) / shape.radius + depth * pixels.points
    inside = np.hypot(*((pixels.points - shape.centre[:, None]) / shape.radius)) < 0.99
    assert np.abs(np.hypot(*met)[inside] - 1.0).max() < 1e-5
