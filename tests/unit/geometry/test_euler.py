"""Three angles and back, above all at the poles, where two of them mean the same."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from cellctl.geometry.euler import EulerOrder

ANGLES = st.floats(-math.pi, math.pi)
NEAR_POLE = st.sampled_from([0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3])
SIGN = st.sampled_from([-1.0, 1.0])
ORDERS = st.sampled_from(EulerOrder)


def angle_between(one: Rotation, other: Rotation) -> float:
    return float((one.inv() * other).magnitude())


def test_each_order_by_hand() -> None:
    rx, ry, rz = 0.3, -0.5, 1.1
    x, y, z = (Rotation.from_euler(*one) for one in (("x", rx), ("y", ry), ("z", rz)))
    assert angle_between(EulerOrder.FIXED_XYZ.rotation([rx, ry, rz]), z * y * x) < 1e-12
    assert angle_between(EulerOrder.MOVING_XYZ.rotation([rx, ry, rz]), x * y * z) < 1e-12
    vector = EulerOrder.ROTATION_VECTOR.rotation([0.0, 0.0, rz])
    assert angle_between(vector, z) < 1e-12


def test_the_orders_differ() -> None:
    angles = [math.radians(30.0), math.radians(40.0), 0.0]
    rotations = [order.rotation(angles) for order in EulerOrder]
    for index, one in enumerate(rotations):
        for other in rotations[index + 1 :]:
            assert angle_between(one, other) > 0.1


@given(ORDERS, ANGLES, ANGLES, ANGLES)
def test_there_and_back(order: EulerOrder, rx: float, ry: float, rz: float) -> None:
    rotation = order.rotation([rx, ry, rz])
    angles = order.angles(rotation)
    assert np.all(np.abs(angles) <= math.pi + 1e-12)
    assert angle_between(order.rotation(angles), rotation) < 1e-9


@given(ORDERS, ANGLES, SIGN, NEAR_POLE, ANGLES)
def test_at_and_beside_the_poles(
    order: EulerOrder, rx: float, sign: float, beside: float, rz: float
) -> None:
    rotation = order.rotation([rx, sign * (math.pi / 2 - beside), rz])
    assert angle_between(order.rotation(order.angles(rotation)), rotation) < 1e-9


@pytest.mark.parametrize("order", [EulerOrder.FIXED_XYZ, EulerOrder.MOVING_XYZ])
@pytest.mark.parametrize("ry", [-math.pi / 2, math.pi / 2])
def test_at_a_pole_the_first_angle_is_zero(order: EulerOrder, ry: float) -> None:
    angles = order.angles(order.rotation([0.4, ry, 0.7]))
    assert angles[1] == pytest.approx(ry)
    assert angles[0] == 0.0


@pytest.mark.parametrize("order", list(EulerOrder))
@pytest.mark.parametrize("angles", [[0.0, 0.0], [0.0, 0.0, float("nan")], [0.0, 0.0, math.inf]])
def test_what_is_no_orientation_is_refused(order: EulerOrder, angles: list[float]) -> None:
    with pytest.raises(ValueError, match="three finite numbers"):
        order.rotation(angles)
