import numpy as np
import pytest

from cellctl.force.contact.streamed.admittance import (
    RAMP_S,
    Admittance,
    AdmittanceBounds,
    AdmittanceGains,
    PushRamp,
)
from cellctl.geometry.pose import Array

PERIOD_S = 4e-3
SPEED = np.repeat([1e-3, 0.05], 3)
BOUNDS = AdmittanceBounds(SPEED, np.repeat([0.1, 5.0], 3), np.repeat([1e-3, 0.05], 3))


def gains(damping: float = 3e4, spring: float = 0.0) -> AdmittanceGains:
    lever = np.array([1, 1, 1, 0.014**2, 0.014**2, 0.014**2])
    return AdmittanceGains(
        10.0 * lever, damping * lever, spring * lever, np.array([True] * 6, dtype=bool)
    )


def along_z(force_n: float) -> Array:
    return np.array([0.0, 0.0, force_n, 0.0, 0.0, 0.0])


def test_a_push_that_equals_what_is_felt_moves_nothing() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    felt = np.array([1.0, -2.0, -8.0, 0.1, 0.0, -0.05])
    ramp = PushRamp(felt, along_z(8.0), PERIOD_S)
    first = law.step(ramp.step(), felt)
    assert np.abs(first[:3]).max() < 0.01e-3
    for _ in range(round(RAMP_S / PERIOD_S) + 1):
        push = ramp.step()
    assert push == pytest.approx(along_z(8.0))


def test_a_steady_push_moves_at_push_over_damping() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    for _ in range(200):
        law.step(along_z(8.0), np.zeros(6))
    assert law.velocity[2] == pytest.approx(8.0 / 3e4)


def test_a_spring_holds_against_a_force() -> None:
    law = Admittance(gains(spring=5e4), BOUNDS, PERIOD_S)
    for _ in range(2000):
        moved = law.step(np.zeros(6), along_z(10.0))
    assert moved[2] == pytest.approx(10.0 / 5e4, rel=1e-3)


def test_a_change_of_gains_keeps_place_and_speed() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    for _ in range(100):
        before = law.step(along_z(8.0), np.zeros(6))
    law.gains = gains(damping=9e4)
    after = law.step(along_z(8.0), np.zeros(6))
    assert np.abs(after - before).max() < 0.01e-3


def test_it_leaves_a_bound_within_three_ticks() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    for _ in range(round(6.0 / PERIOD_S)):
        held = law.step(along_z(50.0), np.zeros(6))
    assert held[2] == pytest.approx(1e-3)
    assert law.at_bound[2]
    for _ in range(3):
        left = law.step(along_z(50.0), along_z(-60.0))
    assert left[2] < held[2]
    assert not law.velocity[2] > 0


def test_speed_and_acceleration_are_bounded() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    before = np.zeros(6)
    for _ in range(50):
        speed = law.velocity
        moved = law.step(along_z(1e3), np.zeros(6))
        assert np.all(np.abs(moved - before) <= SPEED * PERIOD_S * 1.000001)
        assert abs(law.velocity[2] - speed[2]) <= 0.1 * PERIOD_S * 1.000001
        before = moved


def test_a_late_tick_repeats_the_target_and_halves_the_speed() -> None:
    law = Admittance(gains(), BOUNDS, PERIOD_S)
    for _ in range(100):
        moved = law.step(along_z(8.0), np.zeros(6))
    speed = law.velocity[2]
    assert np.array_equal(law.hold(), moved)
    assert law.velocity[2] == pytest.approx(speed / 2)
    for _ in range(3):
        law.brake()
    assert law.velocity[2] == 0.0


def test_axes_that_do_not_follow_stay() -> None:
    only_z = gains()
    only_z.follows[[0, 1, 3, 4, 5]] = False
    law = Admittance(only_z, BOUNDS, PERIOD_S)
    for _ in range(100):
        moved = law.step(np.ones(6), np.zeros(6))
    assert np.flatnonzero(moved).tolist() == [2]


def test_small_turns_add_up_as_rotations() -> None:
    wide = AdmittanceBounds(SPEED, BOUNDS.acceleration, np.full(6, 1.0))
    law = Admittance(gains(damping=300.0), wide, PERIOD_S)
    for _ in range(500):
        moved = law.step(np.array([0, 0, 0, 1.0, 0, 0]), np.zeros(6))
    assert moved[3:] == pytest.approx([0.1, 0.0, 0.0], abs=3e-3)
