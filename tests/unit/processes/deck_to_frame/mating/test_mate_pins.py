"""A mating onto pins that stand beside their place: rigid, giving way, and at the bound."""

import numpy as np
import pytest

from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress
from cellctl.processes.deck_to_frame.mating.settings import PinSettings
from tests.rigs.mating.trial import PINS, Hook, Trial, run_trial

BESIDE_MM, YAW_DEG = 0.08, 0.004
ENGAGED_M = (PINS.length_mm + 0.1) * MM


def mated(pins: PinSettings | None, hook: Hook | None = None) -> Trial:
    """As commissioned with this pair of parts, and a quick stop: fast for a mating."""
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


@pytest.mark.long
def test_the_bound_of_the_way_is_kept_and_the_rest_is_a_fault() -> None:
    bound_m = 1e-5
    trial = mated(PinSettings(ENGAGED_M, greatest_travel_m=bound_m, greatest_yaw_rad=1e-5))
    assert trial.outcome == "F522"
    assert "giving way by 0.010 mm" in trial.text
    assert trial.true_peak_n < 50.0
    assert trial.reached_mm - trial.end_travel_mm == pytest.approx(2.0, abs=0.1), "backed off"


@pytest.mark.long
def test_no_fast_travel_onto_pins_without_the_option() -> None:
    """What happens when the recipe does not know of them: a fault, and no seat."""
    trial = mated(None)
    assert trial.outcome in {"F522", "F525"}
    assert trial.standing
