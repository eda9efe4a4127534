"""What counts as seated by truth: faces that are closed, whatever carries the force."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from tests.rigs.mating.cell import SCENARIO
from tests.rigs.mating.seat_truth import SeatTruth, seat_truth
from tests.rigs.mating.trial import Trial, draw_trial, run_trial

SEED = 502
"""Its seat is one of the softest, and a burr carries a third of what presses."""


@pytest.fixture(scope="module")
def world() -> DeckOnFrame:
    """A deck that is flat and bored where the drawing says, on a frame without pins."""
    scenario = DeckScenario.read(SCENARIO, {"deck_flex": 0.0})
    parts = scenario.parts.model_copy(update={"hole_sigma_mm": 0.0})
    return DeckOnFrame(scenario.model_copy(update={"parts": parts}), SEED)


def sitting(
    world: DeckOnFrame, height_mm: float, about_y_deg: float = 0.0, beside_mm: float = 0.0
) -> SeatTruth:
    parts = world.placed.parts
    assert parts is not None
    place = [beside_mm * 1e-3, 0.0, parts.deck_thickness_m + height_mm * 1e-3]
    turned = Rotation.from_euler("y", about_y_deg, degrees=True)
    return seat_truth(world, RigidTransform.from_components(place, turned))


def test_a_face_that_is_closed_all_round_has_no_gap_however_deep_it_is_pressed(
    world: DeckOnFrame,
) -> None:
    for height_mm in (-0.005, -0.2):
        truth = sitting(world, height_mm)
        assert truth.gap_mm == pytest.approx(0.0, abs=1e-6)
        assert truth.opening_mm == 0.0


def test_what_stands_on_something_else_has_the_whole_gap(world: DeckOnFrame) -> None:
    truth = sitting(world, 0.115)
    assert truth.gap_mm == pytest.approx(0.115)
    assert truth.opening_mm == pytest.approx(0.115)


def test_a_tilted_deck_is_open_on_one_side(world: DeckOnFrame) -> None:
    truth = sitting(world, 0.0, about_y_deg=0.01)
    edge_mm = 490.0 * np.deg2rad(0.01)
    assert truth.opening_mm == pytest.approx(edge_mm, rel=0.02)
    assert 0.2 * edge_mm < truth.gap_mm < 0.5 * edge_mm


def test_the_pins_are_judged_across_the_approach(world: DeckOnFrame) -> None:
    assert sitting(world, 0.0).pin_error_mm == pytest.approx(0.0, abs=1e-9)
    assert sitting(world, 3.0, beside_mm=0.07).pin_error_mm == pytest.approx(0.07)


def test_good_is_what_is_within_every_limit_and_known() -> None:
    good = replace(
        Trial("good", 1, 1e6, 20.0, outcome="seated"),
        final_true_n=37.0,
        true_gap_mm=0.03,
        true_pin_error_mm=0.02,
    )
    assert not good.false_complete
    for key, value in (
        ("final_true_n", 34.0),
        ("true_gap_mm", 0.11),
        ("true_gap_mm", -0.11),
        ("true_pin_error_mm", 0.21),
        ("true_gap_mm", float("nan")),
        ("true_pin_error_mm", float("nan")),
    ):
        wrong = replace(good)
        setattr(wrong, key, value)
        assert wrong.false_complete, key
        wrong.outcome = "false seat"
        assert not wrong.false_complete, key


@pytest.mark.long
def test_a_burr_that_carries_a_third_of_the_force_opens_no_soft_seat() -> None:
    trial = run_trial(draw_trial(SEED))
    assert trial.outcome == "seated", trial.text
    assert trial.true_opening_mm == 0.0
    assert not trial.false_complete
    assert abs(trial.judged_gap_mm - trial.true_gap_mm) < 0.05
