"""Three angles and back, above all at the poles, where two of them mean the same."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from cellctl.geometry.euler import angles_of, rotation_of
from cellctl.geometry.euler_order import EulerOrder

ANGLES = st.floats(-math.pi, math.pi)
NEAR_POLE = st.sampled_from([0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3])
SIGN = st.sampled_from([-1.0, 1.0])
ORDERS = st.sampled_from(EulerOrder)


def angle_between(one: Rotation, other: Rotation) -> float:
    return float((one.inv() * other).magnitude())


def test_each_order_by_hand() -> None:
    rx, ry, rz = 0.3, -0.5, 1.1
    x, y, z = (Rotation.from_euler(*one) for one in (("x", rx), ("y", ry), ("z", rz)))
    assert angle_between(rotation_of(EulerOrder.FIXED_XYZ, [rx, ry, rz]), z * y * x) < 1e-12
    assert angle_between(rotation_of(EulerOrder.MOVING_XYZ, [rx, ry, rz]), x * y * z) < 1e-12
    vector = rotation_of(EulerOrder.ROTATION_VECTOR, [0.0, 0.0, rz])
    assert angle_between(vector, z) < 1e-12


def test_the_orders_differ() -> None:
    angles = [math.radians(30.0), math.radians(40.0), 0.0]
    rotations = [rotation_of(order, angles) for order in EulerOrder]
    for index, one in enumerate(rotations):
        for other in rotations[index + 1 :]:
            assert angle_between(one, other) > 0.1


@given(ORDERS, ANGLES, ANGLES, ANGLES)
def test_there_and_back(order: EulerOrder, rx: float, ry: float, rz: float) -> None:
    rotation = rotation_of(order, [rx, ry, rz])
    angles = angles_of(order, rotation)
    assert np.all(np.abs(angles) <= math.pi + 1e-12)
    assert angle_between(rotation_of(order, angles), rotation) < 1e-9


@given(ORDERS, ANGLES, SIGN, NEAR_POLE, ANGLES)
def test_at_and_beside_the_poles(
    order: EulerOrder, rx: float, sign: float, beside: float, rz: float
) -> None:
    rotation = rotation_of(order, [rx, sign * (math.pi / 2 - beside), rz])
    # Up to 1e-9 rad beside a pole counts as the pole: the way there, and as much across it.
    assert angle_between(rotation_of(order, angles_of(order, rotation)), rotation) < 2.1e-9


@pytest.mark.parametrize("order", [EulerOrder.FIXED_XYZ, EulerOrder.MOVING_XYZ])
@pytest.mark.parametrize("ry", [-math.pi / 2, math.pi / 2])
def test_at_a_pole_the_first_angle_is_zero(order: EulerOrder, ry: float) -> None:
    angles = angles_of(order, rotation_of(order, [0.4, ry, 0.7]))
    assert angles[1] == pytest.approx(ry)
    assert angles[0] == 0.0


@pytest.mark.parametrize("order", list(EulerOrder))
@pytest.mark.parametrize("angles", [[0.0, 0.0], [0.0, 0.0, float("nan")], [0.0, 0.0, math.inf]])
def test_what_is_no_orientation_is_refused(order: EulerOrder, angles: list[float]) -> None:
    with pytest.raises(ValueError, match="three finite numbers"):
        rotation_of(order, angles)


@given(ORDERS, ANGLES, ANGLES, ANGLES)
def test_rows_without_arrays_are_those_of_scipy(
    order: EulerOrder, rx: float, ry: float, rz: float
) -> None:
    expected = {
        EulerOrder.FIXED_XYZ: Rotation.from_euler("xyz", [rx, ry, rz]),
        EulerOrder.MOVING_XYZ: Rotation.from_euler("XYZ", [rx, ry, rz]),
        EulerOrder.ROTATION_VECTOR: Rotation.from_rotvec([rx, ry, rz]),
    }[order]
    assert np.reshape(order.rows(rx, ry, rz), (3, 3)) == pytest.approx(
        expected.as_matrix(), abs=1e-12
    )
