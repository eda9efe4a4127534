"""The conditions of ``make bench-looks`` are what they are called, and shift no truth."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.metrology.drawn_conditions import DEVELOPED, HELD_BACK
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
        # A disc of confusion of 2 px is not the Gaussian of the model: it may be refused, with a
        # reason that names the rim.
        assert "F421" in fault
        return
    assert fault is None
    assert errors.worst_px() < 0.12


def test_a_half_fails_when_its_holes_are_not_seen() -> None:
    dark = replace(DEVELOPED["none"], light=lambda image, _: np.zeros_like(image))
    table, reached = half("none seen", {"dark": dark}, 1)
    assert table.row_count == 2
    assert not reached
