"""What a check remarks on in a recipe that is good otherwise."""

import shutil
from pathlib import Path

from cellctl.config.issue import ConfigIssue
from cellctl.config.load import load_cell
from cellctl.processes.deck_to_frame.checks.plausible.remarks import recipe_remarks
from cellctl.processes.deck_to_frame.recipe import DeckRecipe

CONFIG = Path(__file__).parents[6] / "config"


def remarks(folder: Path) -> list[ConfigIssue]:
    cell = load_cell(folder / "deck.toml")
    (recipe,) = cell.recipes
    assert isinstance(recipe, DeckRecipe)
    return list(recipe_remarks(cell, recipe, "recipes.0", folder))


def test_a_thickness_that_is_stated_once_is_remarked_on(tmp_path: Path) -> None:
    folder = tmp_path / "config"
    shutil.copytree(CONFIG, folder)
    key = "recipes.0.deck_thickness_mm"
    assert key not in [one.key for one in remarks(folder)]
    file = folder / "features" / "deck.toml"
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(line for line in lines if not line.startswith("thickness_mm")))
    assert key in [one.key for one in remarks(folder)]


def test_a_countersink_that_holds_no_head_is_remarked_on(tmp_path: Path) -> None:
    folder = tmp_path / "config"
    shutil.copytree(CONFIG, folder)
    file = folder / "features" / "deck.toml"
    file.write_text(file.read_text().replace("countersink_mm = 10.0", "countersink_mm = 6.0"))
    (found,) = [one for one in remarks(folder) if one.key == "recipes.0.deck_features"]
    assert "hole P2, countersink_mm = 6: the countersink is 1.2 times" in found.allowed
