"""Pins that are halved or doubled in both drawings of the fake cell, where they agree."""

from dataclasses import replace
from pathlib import Path
from typing import cast

import pytest

from cellctl.config import load_cell
from cellctl.config.issue import ConfigIssue
from cellctl.processes.deck_to_frame.checks.pin_sizes import pin_size_remarks
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing, read_drawings
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

CONFIG = Path(__file__).parents[5] / "config"


def found(pin_mm: float, screw_mm: float = 5.0) -> list[ConfigIssue]:
    """What is said with pins and screws of these diameters in both drawings."""
    recipe = cast(DeckRecipe, load_cell(CONFIG / "deck.toml").recipes[0])
    deck, frame = read_drawings(recipe, "recipes.0", CONFIG)
    return list(pin_size_remarks(_drawn(deck, pin_mm, screw_mm), _drawn(frame, pin_mm, screw_mm)))


def _drawn(drawing: PartDrawing, pin_mm: float, screw_mm: float) -> PartDrawing:
    holes = tuple(
        replace(hole, diameter_m=(pin_mm if hole.kind == "pin" else screw_mm) * 1e-3)
        for hole in drawing.features.holes
    )
    return replace(drawing, features=replace(drawing.features, holes=holes))


@pytest.mark.parametrize("pin_mm", [3.0, 12.0])
def test_pins_that_are_halved_or_doubled_are_held_against_the_screws(pin_mm: float) -> None:
    """Each is a dowel that there is, and both drawings have it."""
    (remark,) = found(pin_mm)
    assert remark.key == "recipes.0.deck_features"
    assert f"hole P1, diameter_mm = {pin_mm:g}: the screws beside it have 5 mm" in remark.allowed


@pytest.mark.parametrize(("pin_mm", "screw_mm"), [(3.0, 4.0), (6.0, 5.0), (8.0, 5.0), (6.0, 3.0)])
def test_pins_as_they_are_in_use_pass(pin_mm: float, screw_mm: float) -> None:
    assert found(pin_mm, screw_mm) == []


def test_a_size_that_is_odd_for_both_reasons_is_named_once() -> None:
    (remark,) = found(3.4)
    assert "no dowel has this diameter" in remark.allowed
