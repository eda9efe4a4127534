"""Bodies of deck and frame in the model of a cell against the recipe."""

import shutil
from pathlib import Path
from typing import cast

import pytest

from cellctl.config.commissioning import examine_before_commissioning
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import model_path, stated_model
from cellctl.processes.deck_to_frame.checks.modelled_parts import modelled_part_issues
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from tests.rigs.shipped import shipped_cell
from tests.unit.planning.deck_cell import DECK, write_model

CELL = shipped_cell(DECK.name)
DECK_BOX = "size_mm = [1000.0, 500.0, 15.0], at = [0.0, 0.0, 509.5, 0.0, 0.0, 0.0]"
FRAME_BOX = "size_mm = [1000.0, 500.0, 20.0], at = [1900.0, 0.0, 390.0, 90.0, 0.0, 0.0]"


def found(model: Path) -> list[ConfigIssue]:
    recipe = cast(DeckRecipe, CELL.recipes[0])
    return list(modelled_part_issues(CELL, recipe, "recipes.0", stated_model(model)))


def changed(folder: Path, box: str, old: str, new: str) -> list[ConfigIssue]:
    assert old in box
    return found(write_model(folder, box, box.replace(old, new, 1)))


def test_the_shipped_model_holds_the_parts_of_its_recipe() -> None:
    stated = stated_model(model_path(DECK))
    assert "deck" in {box.name for box in stated.at_flange["main"]}
    assert "frame" in {box.name for box in stated.fixtures}
    assert found(model_path(DECK)) == []


@pytest.mark.parametrize(
    ("box", "old", "new", "said"),
    [
        (DECK_BOX, "1000.0, 500.0", "500.0, 1000.0", "did you mean size_mm = [1000.0, 500.0, 15"),
        (DECK_BOX, "1000.0, 500.0", "1000.0, 50.0", "does not hold its corners"),
        (DECK_BOX, "[0.0, 0.0, 509.5", "[100.0, 0.0, 509.5", "does not hold its corners"),
        (DECK_BOX, "509.5, 0.0", "509.5, 30.0", "does not hold its corners"),
        (DECK_BOX, " 509.5", " 459.5", "begins 50 mm above it"),
        (DECK_BOX, " 509.5", " 559.5", "ends 50 mm below it"),
        (FRAME_BOX, " 390.0", " 290.0", "ends 100 mm below it"),
        (FRAME_BOX, " 390.0", " 1390.0", "begins 980 mm above it"),
        (FRAME_BOX, " 90.0", " 0.0", "did you mean size_mm = [500.0, 1000.0, 20.0]?"),
        (FRAME_BOX, "[1900.0, 0.0", "[1900.0, 60.0", "does not hold its corners"),
    ],
)
def test_a_body_that_lacks_some_of_the_part_is_told(
    tmp_path: Path, box: str, old: str, new: str, said: str
) -> None:
    (issue,) = changed(tmp_path, box, old, new)
    body = "robots.main.bodies.deck" if box == DECK_BOX else "fixtures.frame"
    assert issue.key == f"deck.model.toml: {body}"
    assert said in issue.allowed
    assert {one.key for one in issue.against} >= {"recipes.0.face_mm"}


@pytest.mark.parametrize(
    ("box", "old", "new"),
    [
        (DECK_BOX, "1000.0, 500.0, 15.0", "1100.0, 600.0, 40.0"),
        (DECK_BOX, "[0.0, 0.0, 509.5", "[10.0, 0.0, 509.5"),
        (FRAME_BOX, "500.0, 20.0", "700.0, 200.0"),
        (FRAME_BOX, " 390.0", " 380.0"),
    ],
)
def test_a_body_that_holds_the_part_may_be_more(
    tmp_path: Path, box: str, old: str, new: str
) -> None:
    assert changed(tmp_path, box, old, new) == []


def test_of_several_bodies_one_has_to_hold_the_part(tmp_path: Path) -> None:
    low = FRAME_BOX.replace(" 390.0", " 290.0")
    frame = f"frame = {{ box = {{ {FRAME_BOX} }} }}"
    both = f"{frame.replace(FRAME_BOX, low)}\n{frame.replace('frame', 'frame_of_recipe_1')}"
    assert found(write_model(tmp_path, frame, both)) == []


def test_bodies_of_other_names_and_meshes_are_left_to_their_author(tmp_path: Path) -> None:
    assert found(write_model(tmp_path, "frame = { box", "table = { box")) == []
    mesh = 'mesh = { file = "deck.stl" }'
    assert found(write_model(tmp_path, f"box = {{ {DECK_BOX} }}", mesh)) == []


def test_check_says_it_of_a_cell_file_beside_such_a_model(tmp_path: Path) -> None:
    for name in ("features", "demo-calibration"):
        shutil.copytree(DECK.parent / name, tmp_path / name)
    cell_file = Path(shutil.copy(DECK, tmp_path))
    write_model(tmp_path, FRAME_BOX, FRAME_BOX.replace(" 390.0", " 290.0"))
    (issue,) = examine_before_commissioning(cell_file).errors
    assert issue.key == "deck.model.toml: fixtures.frame"
    assert issue.against[0].key == "recipes.0.base_T_frame"
    assert issue.against[0].line is not None
