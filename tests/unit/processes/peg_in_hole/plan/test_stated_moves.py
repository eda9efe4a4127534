"""The moves of a pin and of a plug against the models of their cells, and against where a run sends
the arm."""

from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from cellctl.config.model_file import model_path
from cellctl.config.stated.moves import MoveKind
from cellctl.errors.config import ClearanceTooSmall
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.planning.model.read import read_model
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.ways.check_moves import check_move, stated_moves
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from tests.rigs.shipped import shipped_cell

PIN, CONNECTOR = (Path(f"config/insertion-{name}.toml") for name in ("pin", "connector"))
SCENE, CONNECTOR_SCENE = (
    read_model(shipped_cell(file.name), model_path(file), file.parent) for file in (PIN, CONNECTOR)
)
MOVES = list(stated_moves(SCENE))
RECIPE = cast(PegRecipe, SCENE.cell.recipes[0])


@pytest.mark.parametrize("scene", [SCENE, CONNECTOR_SCENE], ids=["pin", "connector"])
def test_every_move_of_the_shipped_cells_is_free(scene: CellScene) -> None:
    checked = {move.name: check_move(scene, move).fault for move in stated_moves(scene)}
    assert checked
    assert {name: str(fault) for name, fault in checked.items() if fault is not None} == {}


def test_the_plug_may_meet_the_socket_in_an_approach_only() -> None:
    down = next(move for move in stated_moves(CONNECTOR_SCENE) if move.end.label == "seat")
    checked = check_move(CONNECTOR_SCENE, replace(down, approach=False))
    assert isinstance(checked.fault, ClearanceTooSmall)
    assert "arm.plug and socket" in str(checked.fault)


def tip_mm(place: str) -> np.ndarray:
    """The tip in the frame of the hole at the place of this label, in mm."""
    found = next(end for move in MOVES for end in (move.start, move.end) if end.label == place)
    flange = found.base_T_flange
    if flange is None:
        flange = SCENE.arms["arm"].base_T_flange(found.joints_rad)
    hole, held = pose_from_xyzabc(RECIPE.base_T_hole.pose), pose_from_xyzabc(RECIPE.flange_T_tip)
    return np.asarray((hole.inv() * flange * held).translation) / MM


def test_the_tip_comes_to_the_seat_and_to_the_circle_of_the_touches() -> None:
    assert tip_mm("seat") == pytest.approx([0.0, 0.0, -12.0 - 1.5], abs=1e-6)
    for number in (1, 2, 3, 4):
        x_mm, y_mm, z_mm = tip_mm(f"touch {number}")
        assert np.hypot(x_mm, y_mm) == pytest.approx(8.0)
        assert z_mm == pytest.approx(-1.5)


def test_the_arm_leaves_the_hole_along_its_axis_before_it_goes_home() -> None:
    (out,) = [move for move in MOVES if move.start.label == "seat"]
    assert out.kind is MoveKind.LINEAR
    assert out.approach
    assert tip_mm(out.end.label) == pytest.approx([0.0, 0.0, 15.0 + 1.5], abs=1e-6)
    (back,) = [move for move in MOVES if move.start.label == out.end.label]
    assert (back.kind, back.end.label, back.approach) == (MoveKind.JOINT, "home", False)
