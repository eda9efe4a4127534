"""Sizes by which an exposure is found, held against the holes of the fake cell's deck and frame."""

from pathlib import Path
from typing import cast

import pytest

from cellctl.config import load_cell
from cellctl.config.devices import AutoExposureConfig
from cellctl.processes.deck_to_frame.checks.hole_sizes import hole_size_remarks
from cellctl.processes.deck_to_frame.checks.plausible.drawing import read_drawings
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

CONFIG = Path(__file__).parents[5] / "config"


@pytest.mark.parametrize(
    ("hole_px", "said"),
    [((20.0, 60.0), False), ((60.0, 90.0), True), ((30.0, 60.0), True), ((4.2, 6.0), False)],
)
def test_sizes_beside_the_drawn_holes_are_remarked_on(
    hole_px: tuple[float, float], *, said: bool
) -> None:
    cell = load_cell(CONFIG / "deck.toml")
    wanted = {"auto_exposure": AutoExposureConfig(hole_px=hole_px)}
    head = cell.stereo_cameras["head_1"].model_copy(update=wanted)
    cameras = {"stereo_cameras": {**cell.stereo_cameras, "head_1": head}}
    cell = cell.model_copy(update=cameras)
    recipe = cast(DeckRecipe, cell.recipes[0])
    drawings = read_drawings(recipe, "recipes.0", CONFIG)
    found = list(hole_size_remarks(cell, recipe, drawings, CONFIG))
    assert [one.key for one in found] == ["stereo_cameras.head_1.auto_exposure.hole_px"] * said
    assert all("have radii of 16 to 22 px" in one.allowed for one in found)
