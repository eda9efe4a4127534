"""What recordings can be of, and what they cannot."""

import numpy as np
import pytest

from cellctl.force.contact.recorded_units import (
    impossible_depths,
    impossible_forces,
    impossible_sampling,
    impossible_speed,
    unread_component,
)

DEPTHS_M = np.linspace(-1e-3, 2.5e-3, 500)


@pytest.mark.parametrize("speed_mm_s", [0.02, 0.4, 5.0, 50.0])
@pytest.mark.parametrize("waited_s", [0.0, 40.0])
def test_any_speed_that_an_arm_has_is_possible(speed_mm_s: float, waited_s: float) -> None:
    time_s = (DEPTHS_M - DEPTHS_M[0]) / (speed_mm_s * 1e-3)
    time_s[-1] += waited_s
    assert impossible_sampling(time_s, "t_s") is None
    assert impossible_speed(time_s, DEPTHS_M, "t_s") is None


@pytest.mark.parametrize(
    ("speed_m_s", "count", "said"),
    [
        (2e-6, 8000, "at least 0.01 mm/s"),
        (2.0, 100, "at most 500 mm/s"),
        (2e-6, 500, "at most 0.5 s"),
        (2.0, 500, "at least 1e-05 s"),
    ],
)
def test_speeds_and_rates_that_no_arm_has_are_not(speed_m_s: float, count: int, said: str) -> None:
    depths_m = np.linspace(-1e-3, 2.5e-3, count)
    time_s = (depths_m - depths_m[0]) / speed_m_s
    why = impossible_sampling(time_s, "t_s") or impossible_speed(time_s, depths_m, "t_s")
    assert why is not None
    assert why.startswith("t_s: ")
    assert said in why


def test_a_part_that_does_not_go_in_has_no_speed() -> None:
    time_s = np.linspace(0.0, 5.0, 500)
    assert impossible_speed(time_s, np.zeros(500), "t_s") is None
    assert impossible_speed(time_s, DEPTHS_M[::-1], "t_s") is None


def test_a_part_that_stands_on_its_hole_was_pressed_or_came_from_above() -> None:
    assert impossible_depths(np.array([0.0, 0.15e-3]), 12e-3, "depth_mm") is None
    assert impossible_depths(np.array([-0.5e-3, 0.0]), 12e-3, "depth_mm") is None
    assert impossible_depths(np.array([0.0, 12e-6]), 12e-3, "depth_mm") is not None
    assert impossible_depths(np.array([0.0, 40e-3]), 12e-3, "depth_mm") is not None


def test_noise_alone_and_an_overload_are_possible_forces() -> None:
    names = ("fx_n", "fy_n", "fz_n")
    for greatest_n in (0.1, 30.0, 500.0):
        assert impossible_forces(np.array([[0.0, 0.0, greatest_n]]), 30.0, names) is None
    assert impossible_forces(np.array([[0.0, 0.0, 0.03]]), 30.0, names) is not None
    assert impossible_forces(np.array([[0.0, 0.0, -3e4]]), 30.0, names) is not None


def test_a_component_that_never_changes_was_not_read() -> None:
    names = ("mx_n_m", "my_n_m", "mz_n_m")
    moving = np.random.default_rng(1).normal(0.0, 0.002, (500, 3))
    assert unread_component(moving, names) is None
    moving[:, 1] = 0.0
    why = unread_component(moving, names)
    assert why is not None
    assert why.startswith("my_n_m is 0 in all 500 samples")
