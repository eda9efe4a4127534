"""A peg that stands, slides, is captured, slips in the fingers; keys and contacts of a plug."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fakes.world.peg.fit import Fit, Keys
from fakes.world.peg.held_peg import HeldPeg
from tests.unit.fakes.world.peg.pushing import MM, above, arm, lowered, pin, plug


def _pressed(fit: Fit, x_mm: float, force_n: float, *, tilt_rad: float = 0.0) -> HeldPeg:
    """A peg pressed on whatever is below it."""
    peg = above(fit, arm(1e5, 1e6, 500.0), x_m=x_mm * MM, height_m=0.6 * MM, tilt_rad=tilt_rad)
    while peg.wrench[2] < force_n:
        x, y, z, *turn = peg.pose if not peg.touching else peg.commanded
        peg.follow((x, y, z - 2e-6, turn[0], turn[1], turn[2]), 1e-3)
    return peg


def _pushed(peg: HeldPeg, way_mm: float, step_mm: float = 0.001) -> float:
    """Greatest force against a push along x."""
    most_n = 0.0
    x, y, z, *turn = peg.commanded
    for number in range(1, math.ceil(abs(way_mm) / step_mm) + 1):
        to_m = x + math.copysign(number * step_mm, way_mm) * MM
        peg.follow((to_m, y, z, turn[0], turn[1], turn[2]), 1e-3)
        most_n = max(most_n, -math.copysign(1.0, way_mm) * float(peg.wrench[0]))
    return most_n


@pytest.mark.parametrize("tilt_deg", [0.0, 0.1, 0.5, 8.0])
@pytest.mark.parametrize("friction", [0.1, 0.35])
def test_a_free_peg_on_the_face_slides_and_is_not_captured(
    tilt_deg: float, friction: float
) -> None:
    peg = _pressed(
        replace(pin(0.02, 0.0), friction=friction), 8.0, 2.0, tilt_rad=math.radians(tilt_deg)
    )
    push_n = _pushed(peg, 0.4)
    assert push_n == pytest.approx(friction * peg.wrench[2], rel=0.02)
    assert peg.pose[0] - 8.0 * MM > 0.35 * MM
    assert peg.failures == 0


def test_a_peg_in_the_hole_is_captured() -> None:
    fit = pin(0.05)
    peg = above(fit, arm(1e5, 1e6, 500.0))
    lowered(peg, -5.0 * MM)
    assert _pushed(peg, 0.2) == pytest.approx(1e5 * 0.15 * MM, rel=0.05)
    assert peg.pose[0] == pytest.approx(fit.clearance_m, abs=2e-6)


def test_friction_holds_without_creep() -> None:
    peg = _pressed(pin(0.02, 0.0), 8.0, 8.0)
    _pushed(peg, 0.005)
    place, force = peg.pose, peg.wrench.copy()
    for _ in range(2000):
        peg.follow(peg.commanded, 1e-3)
    assert peg.pose == pytest.approx(place, abs=1e-9)
    assert peg.wrench == pytest.approx(force, abs=1e-3)


def test_a_peg_standing_half_over_the_hole_does_not_run_away() -> None:
    peg = _pressed(pin(0.02, 0.0), 2.0, 8.0)
    for _ in range(300):
        peg.follow(peg.commanded, 1e-3)
    assert np.abs(np.array(peg.pose[:2]) - [2.0 * MM, 0.0]).max() < 0.05 * MM
    assert abs(peg.pose[2]) < 0.05 * MM
    assert np.linalg.norm(peg.wrench[:3]) < 12.0


def test_pushing_in_and_pulling_out_makes_no_energy() -> None:
    # Work of the arm over a closed way is what friction takes: never below zero.
    peg = above(pin(0.02), arm(2e4, 1e6), x_m=0.3 * MM)
    work = 0.0
    down = np.arange(0.1, -3.0, -0.005)
    for z_mm in [*down, *down[::-1]]:
        before_m = peg.commanded[2]
        peg.follow((0.3 * MM, 0.0, z_mm * MM, 0.0, 0.0, 0.0), 1e-3)
        work -= float(peg.wrench[2]) * (peg.commanded[2] - before_m)
    assert 0.0 < work < 0.1
    assert not peg.touching
    assert np.abs(peg.wrench).max() == pytest.approx(0.0, abs=1e-9)


def test_a_spiral_over_the_hole_is_the_same_every_time() -> None:
    ends = []
    for _ in range(2):
        peg = _pressed(pin(0.1), 1.2, 5.0)
        for number in range(400):
            angle = number * 0.02
            radius_mm = 1.2 - number * 0.003
            peg.follow(
                (
                    radius_mm * MM * math.cos(angle), radius_mm * MM * math.sin(angle),
                    peg.commanded[2] - 1e-6, 0.0, 0.004, 0.0,
                ),
                1e-3,
            )  # fmt: skip
        ends.append((peg.pose, peg.wrench.tolist(), peg.touching))
    assert ends[0] == ends[1]


def test_too_hard_a_push_slips_in_the_fingers_and_stays_there() -> None:
    peg = above(pin(0.05), arm(2e4, 1e6), grip_n=60.0)
    rows = lowered(peg, -12.3 * MM)
    assert rows[:, 3].max() < 66.0
    assert peg.slip_m == pytest.approx(0.3 * MM - 60e-6, abs=20e-6)
    assert peg.pose[2] == pytest.approx(-12.0 * MM, abs=10e-6)


def test_the_outer_wall_of_a_plug_resists_from_the_side() -> None:
    peg = above(plug(), arm(1e5), x_m=31.5 * MM)
    lowered(peg, -2.0 * MM, x_m=31.5 * MM, step_m=20e-6)
    assert not peg.touching
    push_n = _pushed(peg, -1.1, 0.005)
    assert push_n == pytest.approx(1e5 * 0.1 * MM, rel=0.02)
    assert peg.pose[0] == pytest.approx(30.5 * MM, abs=2e-6)


def test_keys_let_the_plug_in_at_one_yaw_only() -> None:
    keys = Keys(3.0 * MM, math.radians(1.0))
    peg = HeldPeg(
        replace(plug(), keys=keys), arm(5e4, 1e6, 50.0), (0.0, 0.0, 0.1 * MM, 0.0, 0.0, 0.03)
    )
    for z_mm in np.arange(0.0, -3.02, -0.005):
        peg.follow((0.0, 0.0, z_mm * MM, 0.0, 0.0, 0.03), 1e-3)
    stands_n = peg.wrench[2]
    for yaw in np.arange(0.03, 0.0, -0.0005):
        peg.follow((0.0, 0.0, peg.commanded[2], 0.0, 0.0, yaw), 1e-3)
    assert stands_n == pytest.approx(20.0, rel=0.3)
    assert peg.wrench[2] == pytest.approx(0.0, abs=0.1)
    for z_mm in np.arange(-3.02, -4.0, -0.005):
        peg.follow((0.0, 0.0, z_mm * MM, 0.0, 0.0, 0.0), 1e-3)
    for yaw in np.arange(0.0, 0.05, 0.0005):
        peg.follow((0.0, 0.0, peg.commanded[2], 0.0, 0.0, yaw), 1e-3)
    assert peg.pose[5] == pytest.approx(keys.window_rad, abs=1e-3)
    assert peg.wrench[5] < -1.0


def test_without_its_groove_no_yaw_enters() -> None:
    keys = Keys(3.0 * MM, math.radians(1.0), present=False)
    peg = above(replace(plug(), keys=keys), arm(5e4, 1e6))
    rows = lowered(peg, -3.05 * MM)
    assert rows[-1, 3] == pytest.approx(50.0, rel=0.15)


def test_contacts_of_a_connector_hold_against_a_pull() -> None:
    inside = ((6.0 * MM, 0.0), (7.0 * MM, 40.0), (10.0 * MM, 40.0))
    peg = above(replace(plug(), contact_forces=inside), arm(5e4, 1e6))
    rows = lowered(peg, -8.0 * MM, step_m=10e-6)
    assert rows[-1, 3] == pytest.approx(40.0, rel=0.02)
    x, y, z, *_ = peg.commanded
    for number in range(1, 61):
        peg.follow((x, y, z + number * 2e-6, 0.0, 0.0, 0.0), 1e-3)
    assert peg.wrench[2] == pytest.approx(-40.0, rel=0.05)


def test_a_shape_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="above zero"):
        Fit(0.5 * MM, 3.0 * MM, 12.0 * MM, peg_chamfer_m=0.5 * MM)
    with pytest.raises(ValueError, match="wider"):
        replace(plug(), outer_radius_m=14.0 * MM)
