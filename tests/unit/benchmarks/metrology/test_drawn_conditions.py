"""The conditions of ``make bench-looks`` are what they are called, and shift no truth."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.metrology.drawn_conditions import DEVELOPED, HELD_BACK, Condition
from benchmarks.metrology.drawn_hard import HARD
from benchmarks.metrology.drawn_scenes import drawn_scene
from benchmarks.metrology.figures import HoleErrors
from benchmarks.metrology.looks import half, measure

CONDITIONS = {**DEVELOPED, **HELD_BACK}
_SUB = 8


def test_no_condition_is_in_both_halves() -> None:
    assert not set(DEVELOPED) & set(HELD_BACK)
    assert len(HELD_BACK) >= len(DEVELOPED) - 1


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_point_spread_keeps_light_and_place(name: str) -> None:
    for seed in range(4):
        spread = CONDITIONS[name].spread(np.random.default_rng(seed), _SUB)
        steps = (np.arange(len(spread)) - len(spread) // 2) / _SUB
        assert spread.sum() == pytest.approx(1.0, abs=1e-3)
        assert abs(spread.sum(axis=0) @ steps) < 2e-3
        assert abs(spread.sum(axis=1) @ steps) < 2e-3


@pytest.mark.parametrize(
    "name",
    [
        "none",
        *(pytest.param(one, marks=pytest.mark.figures) for one in CONDITIONS if one != "none"),
    ],
)
def test_a_disc_is_measured_under_every_condition(name: str) -> None:
    errors = HoleErrors()
    fault = measure(drawn_scene("disc", 1, CONDITIONS[name]), errors, "default", skip=0)
    if name == "defocus" and fault is not None:
        # Fitted with a Gaussian first, a rim behind a disc of confusion of 2 px may be refused
        # before all rims tell what it is, with a reason that names it.
        assert "F421" in fault
        return
    assert fault is None
    assert errors.worst_px() < 0.12


@pytest.mark.parametrize(
    ("look", "seed", "condition"),
    [
        ("disc", 1008, HARD["moved"]),
        pytest.param("fading wall", 1001, HARD["moved"], marks=pytest.mark.figures),
        pytest.param("flat cone", 1002, HARD["moved"], marks=pytest.mark.figures),
        pytest.param("lit wall", 1000, DEVELOPED["defocus"], marks=pytest.mark.figures),
        pytest.param("faint wall", 1006, DEVELOPED["defocus"], marks=pytest.mark.figures),
    ],
)
def test_rims_tell_movement_and_focus_of_their_image(
    look: str, seed: int, condition: Condition
) -> None:
    """Where each rim was fitted by itself these were off by 0.05 to 0.4 px."""
    errors = HoleErrors()
    assert measure(drawn_scene(look, seed, condition), errors, "default") is None
    assert errors.worst_px() < 0.1


def test_a_half_fails_when_its_holes_are_not_seen() -> None:
    dark = replace(DEVELOPED["none"], light=lambda image, _: np.zeros_like(image))
    table, reached = half("none seen", {"dark": dark}, 1)
    assert table.row_count == 2
    assert not reached
