"""The border of a jam is where two points of contact slide, whichever way they lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.processes.peg_in_hole.insertion.jam import jam_ratio

R_M, MU = 3e-3, 0.2


def two_points(
    low_n: float, high_n: float, depth_m: float, azimuth_rad: float
) -> tuple[float, ...]:
    """Force and moment on the peg about its tip: pressed at its rim, and opposite at the mouth.

    Both slide, so that each has its friction against the way in.
    """
    aside = np.array([np.cos(azimuth_rad), np.sin(azimuth_rad), 0.0])
    axis = np.array([0.0, 0.0, 1.0])
    rim, mouth = R_M * aside, -R_M * aside - depth_m * axis
    at_rim, at_mouth = -low_n * aside - MU * low_n * axis, high_n * aside - MU * high_n * axis
    force = at_rim + at_mouth
    moment = np.cross(rim, at_rim) + np.cross(mouth, at_mouth)
    return (*force, *moment)


def ratio(wrench: tuple[float, ...], depth_m: float) -> float:
    found = jam_ratio(np.array([wrench[:3]]), np.array([wrench[3:]]), np.array([depth_m]), R_M, MU)
    return float(found[0])


@given(st.floats(10, 100), st.floats(10, 100), st.floats(0.5e-3, 20e-3), st.floats(-np.pi, np.pi))
def test_two_sliding_points_are_on_the_border(
    low_n: float, high_n: float, depth_m: float, azimuth_rad: float
) -> None:
    assert ratio(two_points(low_n, high_n, depth_m, azimuth_rad), depth_m) == pytest.approx(1.0)


@given(st.floats(0.0, 0.9), st.floats(-np.pi, np.pi))
def test_a_push_along_the_axis_beside_it_is_within(share: float, azimuth_rad: float) -> None:
    depth_m = 5e-3
    two = depth_m / (2 * R_M * MU)
    moment_n_m = share * two * R_M * 10.0
    x_n_m, y_n_m = moment_n_m * np.cos(azimuth_rad), moment_n_m * np.sin(azimuth_rad)
    assert ratio((0.0, 0.0, -10.0, x_n_m, y_n_m, 0.0), depth_m) == pytest.approx(share, abs=1e-9)


def test_a_side_force_beyond_the_cone_of_friction_is_outside() -> None:
    assert ratio((60.0, 0.0, -10.0, 0.0, 0.0, 0.0), 5e-3) > 1.0


@pytest.mark.parametrize(("axial_n", "depth_m"), [(1.0, 5e-3), (-10.0, 5e-3), (10.0, 0.1e-3)])
def test_without_a_push_or_a_depth_nothing_is_told(axial_n: float, depth_m: float) -> None:
    assert np.isnan(ratio((1.0, 0.0, -axial_n, 0.0, 0.0, 0.0), depth_m))
