"""A tilted ring seen along the hole, against the points of a circle in space."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes.world.peg.attitude import axis_of
from fakes.world.peg.ellipse import Ellipse

RADIUS_M = 3e-3
SHIFT_M = st.floats(-1e-3, 1e-3)
TILT_RAD = st.floats(-0.2, 0.2)
ANGLE = st.floats(-math.pi, math.pi)


@given(SHIFT_M, SHIFT_M, TILT_RAD, TILT_RAD, ANGLE)
def test_points_lie_on_the_ring(
    x_m: float, y_m: float, tilt_x: float, tilt_y: float, angle: float
) -> None:
    centre, axis = np.array([x_m, y_m, 1e-3]), np.array(axis_of(tilt_x, tilt_y))
    ring = Ellipse.of_ring((x_m, y_m, 1e-3), axis_of(tilt_x, tilt_y), RADIUS_M)
    arm = np.array(ring.point(angle)) - centre
    assert np.linalg.norm(arm) == pytest.approx(RADIUS_M)
    assert arm @ axis == pytest.approx(0.0, abs=1e-12)
    x, y, _ = ring.point(angle)
    squared = ring.squared_distance(math.cos(angle), math.sin(angle))
    assert squared == pytest.approx(x * x + y * y)
    assert ring.point(0.0)[2] <= ring.point(angle)[2] + 1e-12


@given(SHIFT_M, SHIFT_M, TILT_RAD, TILT_RAD, ANGLE)
def test_derivatives_are_those_of_differences(
    x_m: float, y_m: float, tilt_x: float, tilt_y: float, angle: float
) -> None:
    ring = Ellipse.of_ring((x_m, y_m, 0.0), axis_of(tilt_x, tilt_y), RADIUS_M)
    step = 1e-4
    before, at, after = (
        ring.squared_distance(math.cos(one), math.sin(one)) / 2
        for one in (angle - step, angle, angle + step)
    )
    first, second = ring.farther(angle)
    assert first == pytest.approx((after - before) / (2 * step), abs=1e-12)
    assert second == pytest.approx((after - 2 * at + before) / step**2, abs=1e-11)
    edge_squared = RADIUS_M**2
    assert ring.over(angle, edge_squared) == pytest.approx((2 * at - edge_squared, 2 * first))
    way = (np.array(ring.point(angle + step)) - ring.point(angle - step)) / (2 * step)
    assert ring.tangent(angle) == pytest.approx(way, abs=1e-10)
