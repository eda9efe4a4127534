"""Giving way to pins: away from the force, never along the approach, never beyond the bounds."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.force.contact.approach import advance
from cellctl.force.contact.compliance import (
    ComplianceLaw,
    LateralOffset,
    next_move,
    pressed,
)
from cellctl.geometry.pose import pose_from_xyzabc

LAW = ComplianceLaw(
    stiffness_n_m=1e6,
    yaw_stiffness_n_m_rad=3e5,
    damping_n_s_m=5e4,
    period_s=0.6,
    dead_band_n=3.0,
    dead_band_n_m=1.5,
    greatest_step_m=5e-5,
    greatest_step_rad=1e-4,
    greatest_travel_m=2e-4,
    greatest_yaw_rad=5e-4,
)
STAND_OFF = pose_from_xyzabc([1900.0, 0.0, 927.0, 90.0, 0.3, 180.0])
FLANGE_T_DECK = pose_from_xyzabc([1.5, -2.0, 502.3, 0.2, 0.1, 179.9])


def wrench(fx: float = 0.0, fy: float = 0.0, fz: float = 0.0, mz: float = 0.0) -> np.ndarray:
    return np.array([fx, fy, fz, 0.0, 0.0, mz])


@pytest.mark.parametrize("stiffness_n_m", [1e5, 5e5, 1e6])
@pytest.mark.parametrize("error_m", [[6e-5, -4e-5], [-1e-5, 1.2e-4]])
def test_it_converges_without_overshoot(stiffness_n_m: float, error_m: list[float]) -> None:
    """Beyond a clearance of 20 µm a spring pushes back, softer than the bound or as stiff."""
    here, error = LateralOffset(), np.array(error_m)
    sides = []
    for _ in range(200):
        left = error + np.array([here.x_m, here.y_m])
        beyond_m = max(np.hypot(*left) - 2e-5, 0.0)
        force = -stiffness_n_m * beyond_m * left / np.hypot(*left)
        move = next_move(LAW, here, wrench(*force))
        if move is None:
            break
        here = here.plus(move)
        sides.append(left @ error)
    assert np.hypot(*force) <= LAW.dead_band_n
    assert min(sides) > 0.0, "never past the pin's axis"


def test_yaw_follows_the_moment() -> None:
    move = next_move(LAW, LateralOffset(), wrench(mz=6.0))
    assert move is not None
    assert (move.x_m, move.y_m) == (0.0, 0.0)
    assert move.yaw_rad == pytest.approx(LAW.gain * 6.0 / 3e5)


def test_nothing_within_the_dead_band_and_nothing_for_force_along() -> None:
    quiet = wrench(fx=2.0, fy=2.0, fz=45.0, mz=1.4)
    assert not pressed(LAW, quiet)
    assert next_move(LAW, LateralOffset(), quiet) is None
    assert pressed(LAW, wrench(fx=3.1))
    assert pressed(LAW, wrench(mz=-1.6))


def test_single_moves_and_total_travel_are_bounded() -> None:
    here, push = LateralOffset(), wrench(fx=300.0, fy=-400.0, mz=400.0)
    for _ in range(100):
        move = next_move(LAW, here, push)
        if move is None:
            break
        assert move.distance_m <= LAW.greatest_step_m + 1e-12
        assert abs(move.yaw_rad) <= LAW.greatest_step_rad + 1e-12
        here = here.plus(move)
    else:
        pytest.fail("the bound never ends it")
    assert here.distance_m == pytest.approx(LAW.greatest_travel_m)
    assert here.x_m / here.y_m == pytest.approx(-0.75)
    assert here.yaw_rad == pytest.approx(LAW.greatest_yaw_rad)
    back = next_move(LAW, here, -push)
    assert back is not None
    assert here.plus(back).distance_m < here.distance_m, "it may always come back"


def test_a_bound_that_is_too_low_still_converges_up_to_twice_the_stiffness() -> None:
    soft = replace(LAW, stiffness_n_m=6e5)
    left_m = 1e-4
    for _ in range(100):
        move = next_move(soft, LateralOffset(), wrench(fx=-1e6 * left_m))
        if move is None:
            break
        left_m += move.x_m
    assert abs(left_m) * 1e6 <= soft.dead_band_n


def test_the_deck_moves_in_its_own_plane() -> None:
    start = STAND_OFF * FLANGE_T_DECK
    sideways = LateralOffset(1e-4, -5e-5, 2e-4)
    end = advance(STAND_OFF, FLANGE_T_DECK, 0.010, sideways) * FLANGE_T_DECK
    moved: RigidTransform = start.inv() * end
    np.testing.assert_allclose(moved.translation, [1e-4, -5e-5, -0.010], atol=1e-12)
    np.testing.assert_allclose(moved.rotation.as_rotvec(), [0.0, 0.0, 2e-4], atol=1e-12)


def test_without_giving_way_it_is_equation_18() -> None:
    plain = advance(STAND_OFF, FLANGE_T_DECK, 0.0099)
    same = advance(STAND_OFF, FLANGE_T_DECK, 0.0099, LateralOffset())
    np.testing.assert_allclose(same.as_matrix(), plain.as_matrix(), atol=1e-12)
