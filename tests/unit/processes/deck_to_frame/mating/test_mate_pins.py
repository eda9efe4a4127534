"""A mating onto pins that stand beside their place: rigid, giving way, and at the bound."""

import re
from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.mating.pin_search import places
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress
from cellctl.processes.deck_to_frame.mating.settings import PinSettings
from tests.rigs.mating.trial import PINS, Hook, Trial, run_trial

BESIDE_MM, YAW_DEG = 0.08, 0.004
ENGAGED_M = (PINS.length_mm + 0.1) * MM


def mated(pins: PinSettings | None, hook: Hook | None = None) -> Trial:
    """A mating as commissioned with this pair of parts; a quick stop makes it a fast one."""
    left = np.array([BESIDE_MM * MM, 0.0, 0.0, 0.0, 0.0, np.deg2rad(YAW_DEG)])
    trial = Trial("pins", 11, stiffness_n_m=1e6, stop_latency_ms=20.0)
    special = {"pins": PINS, "left": left}
    return run_trial(trial, hook, special=special, pins=pins, stiffness_n_m=5.5e5)


@pytest.mark.long
def test_giving_way_seats_where_a_rigid_deck_is_caught() -> None:
    rigid = mated(PinSettings(ENGAGED_M, compliant=False))
    assert rigid.outcome == "F522", "contact far above the seat"
    assert rigid.true_peak_n < 50.0
    phases: list[MatingProgress] = []
    giving = mated(PinSettings(ENGAGED_M), lambda _, progress: phases.append(progress))
    assert giving.outcome == "seated", giving.text
    assert not giving.false_complete
    assert giving.true_peak_n < 50.0
    assert giving.final_lateral_n < 4.0
    assert (BESIDE_MM - PINS.clearance_mm) * 0.5 < giving.gave_way_mm < BESIDE_MM
    told = [progress for progress in phases if progress.phase is MatingPhase.GIVE_WAY]
    assert len(told) >= 2
    assert all(progress.travel_m < 0.0102 for progress in told)


def stood_on(pins: PinSettings, hook: Hook | None = None) -> Trial:
    """The deck comes farther beside its pins than their chamfers reach: they stand on its face."""
    left = np.array([(PINS.clearance_mm + PINS.chamfer_mm + 0.1) * MM, 0.0, 0.0, 0.0, 0.0, 0.0])
    trial = Trial("pins", 11, stiffness_n_m=1e6, stop_latency_ms=20.0)
    special = {"pins": PINS, "left": left}
    return run_trial(trial, hook, special=special, pins=pins, stiffness_n_m=5.5e5)


WIDE = PinSettings(ENGAGED_M, greatest_travel_m=1.0 * MM)
SEARCHED = replace(WIDE, search_radius_m=1.0 * MM, catch_m=0.5 * MM)


@pytest.mark.long
def test_pins_that_stand_on_the_deck_are_a_fault_without_a_search_and_found_with_one() -> None:
    without = stood_on(WIDE)
    assert without.outcome == "F522"
    assert "1 touches, 0 other places" in without.text
    told: list[MatingProgress] = []
    found = stood_on(SEARCHED, lambda _, progress: told.append(progress))
    assert found.outcome == "seated", found.text
    assert not found.false_complete
    assert found.true_peak_n < 50.0
    assert found.peak_lateral_n < 25.0
    places_tried = sum(progress.phase is MatingPhase.SEARCH for progress in told)
    assert 1 <= places_tried <= len(places(SEARCHED))


@pytest.mark.long
@pytest.mark.parametrize("seed", [11, 14])
def test_short_chamfers_are_passed_below_the_limit(seed: int) -> None:
    """Of 0.06 mm, and the deck slips in its grip beside their walls."""
    short = PINS.model_copy(update={"chamfer_mm": 0.06})
    left = np.array([BESIDE_MM * MM, 0.0, 0.0, 0.0, 0.0, 0.0])
    trial = Trial("pins", seed, stiffness_n_m=1e6, stop_latency_ms=20.0)
    pins = PinSettings(ENGAGED_M, greatest_travel_m=0.5 * MM)
    run_trial(trial, special={"pins": short, "left": left}, pins=pins, stiffness_n_m=5.5e5)
    assert trial.outcome == "seated", trial.text
    assert trial.true_peak_n < 50.0


@pytest.mark.long
def test_pins_under_a_soft_seat_are_met_as_gently_as_under_a_hard_one() -> None:
    """A plan for the seat alone would go on for 250 ms at 0.3 mm/s, and press 80 N."""
    left = np.array([(PINS.clearance_mm + PINS.chamfer_mm + 0.1) * MM, 0.0, 0.0, 0.0, 0.0, 0.0])
    trial = Trial("pins", 11, stiffness_n_m=1e5, stop_latency_ms=250.0)
    special = {"pins": PINS, "left": left}
    run_trial(trial, special=special, pins=PinSettings(ENGAGED_M), stiffness_n_m=1.4e5)
    assert trial.outcome == "F522"
    assert trial.true_peak_n < 50.0


def test_the_places_of_a_search_leave_no_gap_and_stay_within_its_radius() -> None:
    pins = PinSettings(ENGAGED_M, search_radius_m=0.15 * MM, catch_m=0.05 * MM)
    tried = np.array([(0.0, 0.0), *places(pins)])
    assert len(tried) <= 40, "no more than an attempt has touches"
    assert np.hypot(*tried.T).max() <= pins.search_radius_m
    rng = np.random.default_rng(1)
    radius, angle = np.sqrt(rng.uniform(0, 1, 4000)), rng.uniform(0, 2 * np.pi, 4000)
    holes = 0.9 * pins.search_radius_m * radius * np.array([np.cos(angle), np.sin(angle)])
    nearest = np.hypot(*(holes[:, None, :] - tried.T[:, :, None])).min(axis=0)
    assert nearest.max() <= 1.1 * pins.catch_m


def test_no_search_has_no_places() -> None:
    assert places(PinSettings(ENGAGED_M)) == ()


@pytest.mark.long
def test_the_bound_of_the_way_is_kept_and_the_rest_is_a_fault() -> None:
    bound_m = 1e-5
    trial = mated(PinSettings(ENGAGED_M, greatest_travel_m=bound_m, greatest_yaw_rad=1e-5))
    assert trial.outcome == "F522"
    told = re.search(r"giving way by (\S+) mm", trial.text)
    assert told is not None, trial.text
    # Way or turn, whichever comes to its bound first, ends both.
    assert 0.5 * bound_m / MM < float(told[1]) <= bound_m / MM
    assert trial.true_peak_n < 50.0
    assert trial.reached_mm - trial.end_travel_mm == pytest.approx(2.0, abs=0.1), "backed off"


@pytest.mark.long
def test_no_fast_travel_onto_pins_without_the_option() -> None:
    """What happens when the recipe does not know of them: a fault, and no seat."""
    trial = mated(None)
    assert trial.outcome in {"F522", "F525"}
    assert trial.standing
