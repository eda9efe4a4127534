"""Forces of the contact model against closed forms, and against figures of MuJoCo 4.0.1 (32 convex
sectors with a chamfer, a mesh as peg) for the same cases."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fakes.world.peg.fit import Burr, Fit
from tests.unit.fakes.world.peg.pushing import MM, above, arm, at_depth, lowered, pin, plug


@pytest.mark.parametrize(
    ("fit", "off_mm", "lateral_n_m", "one_point_n", "chamfer_n"),
    [
        (pin(0.05), 0.2, 2e4, (2.99, 0.59), (3.21, 4.91)),
        (pin(0.02), 0.5, 2e4, (9.57, 1.92), (9.83, 14.7)),
        (plug(), 0.4, 5e4, (12.39, 2.48), (12.4, 18.6)),
    ],
)
def test_one_point_contact_and_chamfer_are_those_of_mujoco(
    fit: Fit,
    off_mm: float,
    lateral_n_m: float,
    one_point_n: tuple[float, float],
    chamfer_n: tuple[float, float],
) -> None:
    peg = above(fit, arm(lateral_n_m), x_m=off_mm * MM)
    rows = lowered(peg, -3.0 * MM, x_m=off_mm * MM)
    side_n, axial_n = -rows[-1, 1], rows[-1, 3]
    assert side_n == pytest.approx(lateral_n_m * (off_mm * MM - fit.clearance_m), rel=0.01)
    assert side_n == pytest.approx(one_point_n[0], rel=0.1)
    assert axial_n == pytest.approx(one_point_n[1], rel=0.1, abs=0.2)
    on_chamfer = rows[rows[:, 0] < fit.hole_chamfer_m + fit.peg_chamfer_m]
    assert -on_chamfer[:, 1].min() == pytest.approx(chamfer_n[0], rel=0.2)
    assert on_chamfer[:, 3].max() == pytest.approx(chamfer_n[1], rel=0.2)
    assert peg.failures == 0


@pytest.mark.parametrize(
    ("clearance_mm", "tilt_deg", "mujoco_n"),
    [(0.02, 0.5, (22.0, 29.0, 33.0)), (0.05, 1.0, (8.0, 28.0, 41.0))],
)
def test_two_point_contact_is_that_of_mujoco(
    clearance_mm: float, tilt_deg: float, mujoco_n: tuple[float, float, float]
) -> None:
    fit, tilt = pin(clearance_mm), math.radians(tilt_deg)
    peg = above(fit, arm(2e4, turning_nm_rad=200.0), tilt_rad=tilt)
    rows = lowered(peg, -9.1 * MM, step_m=10e-6, tilt_rad=tilt)
    for depth_mm, expected_n in zip((7.0, 8.0, 9.0), mujoco_n, strict=True):
        assert at_depth(rows, depth_mm)[2] == pytest.approx(expected_n, rel=0.25)


@pytest.mark.parametrize(
    ("clearance_mm", "tilt_deg", "turning_nm_rad"),
    [
        (0.01, 0.32, 100.0),
        (0.02, 0.32, 50.0),
        (0.02, 0.5, 100.0),
        (0.05, 1.0, 200.0),
        (0.05, 1.0, 50.0),
    ],
)
def test_a_tilted_peg_jams_with_the_force_of_the_rigid_limit(
    clearance_mm: float, tilt_deg: float, turning_nm_rad: float
) -> None:
    # F = mu K tilt^2 / (4 c), largest at l = 4 c / tilt
    tilt, clearance_m = math.radians(tilt_deg), clearance_mm * MM
    worst_m = 4 * clearance_m / tilt
    fit = replace(pin(clearance_mm, 0.0, normal_n_m=2e10), depth_m=30.0 * MM)
    peg = above(fit, arm(2e4, turning_nm_rad=turning_nm_rad), tilt_rad=tilt)
    lowered(peg, -0.7 * worst_m, step_m=20e-6, tilt_rad=tilt)
    rows = lowered(peg, -1.3 * worst_m, step_m=10e-6, tilt_rad=tilt)
    largest_n = fit.friction * turning_nm_rad * tilt**2 / (4 * clearance_m)
    assert rows[:, 3].max() == pytest.approx(largest_n, rel=0.05)


@pytest.mark.parametrize(
    ("clearance_mm", "tilt_deg", "onset_mm"), [(0.02, 0.5, 4.6), (0.05, 1.0, 5.7)]
)
def test_two_points_begin_where_the_play_is_used_up(
    clearance_mm: float, tilt_deg: float, onset_mm: float
) -> None:
    tilt = math.radians(tilt_deg)
    peg = above(pin(clearance_mm, 0.0), arm(2e4, turning_nm_rad=200.0), tilt_rad=tilt)
    rows = lowered(peg, -7.0 * MM, step_m=10e-6, tilt_rad=tilt)
    # The moment is the sign of two points; contact at the entry has none that lasts.
    first = rows[(rows[:, 0] > 1.0 * MM) & (np.abs(rows[:, 5]) > 0.02)][0, 0]
    assert first == pytest.approx(onset_mm * MM, rel=0.05)


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.35])
def test_the_ratio_of_forces_on_a_chamfer_is_that_of_its_slope(friction: float) -> None:
    fit = Fit(3.0 * MM, 3.02 * MM, 12.0 * MM, 0.5 * MM, 0.5 * MM, friction=friction)
    rows = lowered(above(fit, arm(2e4), x_m=0.5 * MM), -0.8 * MM, x_m=0.5 * MM)
    assert -rows[-1, 1] / rows[-1, 3] == pytest.approx((1 - friction) / (1 + friction), rel=0.02)


def test_a_blocked_hole_stops_the_peg_with_the_stiffness_of_the_arm() -> None:
    fit = Fit(3.0 * MM, 3.05 * MM, 5.0 * MM, 0.5 * MM, 0.5 * MM)
    peg = above(fit, arm(2e4, 1e6))
    lowered(peg, -5.0 * MM)
    assert peg.wrench[2] < 1.0
    rows = lowered(peg, -5.05 * MM, step_m=2e-6)
    assert rows[-1, 3] == pytest.approx(50.0, rel=0.1)
    assert abs(rows[-1, 1]) < 0.1


def test_an_offset_that_a_stiff_arm_forces_in_looks_like_depth() -> None:
    # offset 0.5 mm, 1e6 N/m: F_x 470 N and 94 N of friction that stay constant with depth
    rows = lowered(above(pin(0.02), arm(1e6), x_m=0.5 * MM), -3.0 * MM, x_m=0.5 * MM)
    assert -rows[-1, 1] == pytest.approx(470.0, rel=0.03)
    assert rows[-1, 3] == pytest.approx(94.0, rel=0.03)


def test_a_peg_that_is_too_thick_stops_at_the_chamfer() -> None:
    fit = Fit(3.0 * MM, 2.99 * MM, 12.0 * MM, 0.5 * MM, 0.5 * MM)
    peg = above(fit, arm(2e4, 1e6))
    rows = lowered(peg, -1.2 * MM)
    assert peg.pose[2] == pytest.approx(fit.floor_m, abs=0.02 * MM)
    assert rows[-1, 3] > 150.0
    assert peg.failures == 0


def test_a_burr_pushes_sideways_and_lets_the_peg_by() -> None:
    fit = Fit(
        3.0 * MM, 3.1 * MM, 12.0 * MM, 0.5 * MM, 0.5 * MM,
        burr=Burr(4.0 * MM, 0.15 * MM),
    )  # fmt: skip
    rows = lowered(above(fit, arm(2e4)), -6.0 * MM)
    before, behind = at_depth(rows, 3.0), rows[-1, 1:]
    assert np.abs(before).max() < 0.01
    assert behind[0] == pytest.approx(-2e4 * 0.05 * MM, rel=0.1)
    assert behind[2] == pytest.approx(0.2, rel=0.1)
