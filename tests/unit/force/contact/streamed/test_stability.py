"""Gains and the sampled loop: section 4.1 and R8 of the study of insertion by touch."""

import numpy as np
import pytest

from cellctl.force.contact.streamed.gains import LoopFigures, damping, levers
from cellctl.geometry.pose import Array
from tests.unit.force.contact.streamed.loops import SampledLoop

CHAMFER = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0, 0.014, 0.0])
"""Loads z, x and a rotation at once."""


def designed(stiffness_n_m: float, weights: Array, axes: int, **loop: float) -> SampledLoop:
    """The loop with the gains that the design gives it for what it truly is."""
    made = SampledLoop(stiffness_n_m, weights, np.ones(6), **loop)  # type: ignore[arg-type]
    made.damping = np.where(
        weights != 0,
        damping(LoopFigures(stiffness_n_m, made.dead_time_s), np.where(weights, weights, 1), axes),
        1.0,
    )
    return made


@pytest.mark.parametrize("stiffness_n_m", [1e5, 1e6, 1e7])
@pytest.mark.parametrize("period_s", [1e-3, 4e-3, 12e-3])
@pytest.mark.parametrize("delay_ticks", [2, 8])
def test_three_axes_on_one_contact_stay_stable_when_half_as_much_again_is_true(
    stiffness_n_m: float, period_s: float, delay_ticks: int
) -> None:
    made = designed(stiffness_n_m, CHAMFER, 3, period_s=period_s, delay_ticks=delay_ticks)
    assert made.greatest_eigenvalue() <= 1.0 + 1e-9
    made.stiffness_n_m *= 1.5
    assert made.greatest_eigenvalue() <= 1.0 + 1e-9
    made.delay_ticks = round(1.5 * made.delay_ticks)
    made.arm_lag_s, made.filter_s = 1.5 * made.arm_lag_s, 1.5 * made.filter_s
    assert made.greatest_eigenvalue() <= 1.0 + 1e-9


def test_gains_of_one_axis_do_not_hold_three_with_that_margin() -> None:
    made = designed(1e6, CHAMFER, 1)
    made.stiffness_n_m *= 1.5
    assert made.greatest_eigenvalue() > 1.01


def test_gains_of_the_tip_are_unstable_about_the_sensor() -> None:
    made = designed(1e6, CHAMFER, 3)
    made.weights = np.array([*CHAMFER[:4], 0.2, 0.0])  # 200 mm away instead of 14
    assert made.greatest_eigenvalue() > 1.01
    made.damping = 5 * made.damping  # more than 20 kθ w²
    assert made.greatest_eigenvalue() > 1.01


@pytest.mark.parametrize(
    ("ratio", "low", "high"),
    [
        (0.7, 0.40, 0.80),
        (1.0, 0.15, 0.40),
        (1.5, 0.0, 0.13),
        (2.0, -0.01, 0.04),
        (2.72, -0.01, 0.01),
    ],
)
@pytest.mark.parametrize("delay_ticks", [2, 10])
def test_overshoot_of_a_step_is_that_of_the_table(
    ratio: float, low: float, high: float, delay_ticks: int
) -> None:
    along_z = levers(0.014) * np.array([0, 0, 1, 0, 0, 0])
    made = designed(1e6, along_z, 1, delay_ticks=delay_ticks)
    made.damping = made.damping * ratio / 1.5
    force_n = made.force_n(10.0, round(20 * made.dead_time_s / made.period_s))
    assert low <= force_n.max() / 10.0 - 1.0 <= high
    assert force_n[-1] == pytest.approx(10.0, rel=0.35 if ratio < 1 else 0.03)
