from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.force import ContactPlanInvalid
from cellctl.force.contact.approach import (
    ApproachFigures,
    advance,
    approach_speed,
    contact_sigma,
    contact_window,
    peak_at,
    segment_length,
)
from cellctl.force.contact.touch_detector import Cusum
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.poses.pose_correction import flange_target

FIGURES = ApproachFigures(
    stop_latency_s=0.25,
    stiffness_n_m=1e7 / 11.0,
    contact_stiffness_n_m=1e7,
    moving_mass_kg=200.0,
    deceleration_m_s2=0.1,
    stale_s=5e-3,
    filter_delay_s=5e-3,
    sample_period_s=1e-3,
    touch=Cusum(),
    tare_uncertainty_n=1.5,
    step_sigma_m=3e-6,
)


def test_the_speed_of_the_fake_cell() -> None:
    found = approach_speed(FIGURES, allowed_peak_n=35.0)
    assert 5e-5 < found.speed_m_s < 1.5e-4
    assert found.peak_n == pytest.approx(35.0, abs=1e-3)
    parts = found.touch_n + found.latency_n + found.ramp_n + found.impact_n + found.tare_n
    assert parts == pytest.approx(found.peak_n)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("stop_latency_s", 0.5),
        ("stiffness_n_m", 2e6),
        ("stale_s", 0.15),
        ("filter_delay_s", 0.1),
        ("tare_uncertainty_n", 6.0),
        ("moving_mass_kg", 500.0),
    ],
)
def test_every_figure_that_grows_makes_it_slower(field: str, value: float) -> None:
    change: dict[str, Any] = {field: value}
    worse = replace(FIGURES, **change)
    usual = approach_speed(FIGURES, allowed_peak_n=35.0).speed_m_s
    assert approach_speed(worse, allowed_peak_n=35.0).speed_m_s < usual


def test_the_terms_are_those_of_the_formula() -> None:
    found = peak_at(1e-4, FIGURES)
    stiffness = FIGURES.stiffness_n_m
    assert found.latency_n == pytest.approx(stiffness * 1e-4 * 0.26)
    assert found.ramp_n == pytest.approx(stiffness * 1e-8 / 0.2)
    assert found.impact_n == pytest.approx(1e-4 * np.sqrt(1e7 * 200.0))


def test_no_room_for_the_touch_is_refused() -> None:
    with pytest.raises(ContactPlanInvalid, match="no approach speed"):
        approach_speed(FIGURES, allowed_peak_n=5.0)


def test_a_single_move_cannot_exceed_the_limit() -> None:
    length_m = segment_length(FIGURES, limit_n=45.0)
    worst_n = FIGURES.stiffness_n_m * (length_m + 3.0 * FIGURES.step_sigma_m)
    assert worst_n + 4.0 + 1.5 == pytest.approx(45.0)
    with pytest.raises(ContactPlanInvalid, match="single move"):
        segment_length(replace(FIGURES, step_sigma_m=2e-5), limit_n=45.0)


def window(**changes: float) -> dict[str, float]:
    usual = {
        "expected_m": 0.01,
        "sigma_m": 2e-5,
        "coverage": 4.0,
        "least_half_m": 5e-5,
        "greatest_half_m": 3e-4,
        "tilt_m": 4e-5,
        "margin_m": 2e-4,
    }
    return usual | changes


def test_the_window_follows_the_uncertainty() -> None:
    found = contact_window(**window())
    assert found.latest_m == pytest.approx(0.01 + 8e-5)
    assert found.earliest_m == pytest.approx(0.01 - 8e-5 - 4e-5)
    assert found.clear_m == pytest.approx(found.earliest_m - 2e-4)
    assert contact_window(**window(sigma_m=1e-6)).latest_m == pytest.approx(0.01 + 5e-5)


def test_contact_known_too_badly_or_too_near_is_refused() -> None:
    with pytest.raises(ContactPlanInvalid, match="known to"):
        contact_window(**window(sigma_m=1e-4))
    with pytest.raises(ContactPlanInvalid, match="no clear travel"):
        contact_window(**window(expected_m=2e-4))


def test_uncertainties_join_as_squares() -> None:
    assert contact_sigma(3e-5, 4e-5) == pytest.approx(5e-5)


def test_advancing_is_equation_18_for_a_pure_translation() -> None:
    rng = np.random.default_rng(7)
    flange_T_deck = pose_from_xyzabc([1.0, -2.0, 502.0, 0.3, -0.2, 179.8])
    base_T_C1, C1_T_M = (
        RigidTransform.from_components(rng.normal(size=3), Rotation.random(rng=rng))
        for _ in range(2)
    )
    M_T_D = pose_from_xyzabc([0.01, 0.02, 25.0, 0.0, 0.0, 0.0])
    lower = pose_from_xyzabc([0.01, 0.02, 15.0, 0.0, 0.0, 0.0])
    start = flange_target(base_T_C1, C1_T_M, M_T_D, flange_T_deck)
    end = flange_target(base_T_C1, C1_T_M, lower, flange_T_deck)
    moved = advance(start, flange_T_deck, 0.010)
    np.testing.assert_allclose(moved.as_matrix(), end.as_matrix(), atol=1e-12)
