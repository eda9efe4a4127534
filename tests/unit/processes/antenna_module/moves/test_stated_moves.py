"""The moves of a plugging against the model of its cell, and against the commands of a run."""

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.model_file import model_path
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.geometry.pose import MM, pose_error, pose_from_xyzabc
from cellctl.planning.model.read import read_model
from cellctl.planning.ways.check_moves import check_move, stated_moves
from cellctl.processes.antenna_module.drawings import read_drawings
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from tests.rigs.shipped import shipped_cell
from tests.unit.planning.ways.recorded_moves import covers, motions

ANTENNA = Path("config/antenna.toml")
SCENE = read_model(shipped_cell(ANTENNA.name), model_path(ANTENNA), ANTENNA.parent)
MOVES = list(stated_moves(SCENE))
RECIPE = cast(AntennaRecipe, SCENE.cell.recipes[0])
MOTIONS = motions(Path("tests/data/motion/antenna-run.jsonl"))
PLACED_M = 3.5 * MM
"""Tray and socket may be 2 mm off their drawing, and the module is gripped as far off as 1.5 mm."""
OF_RUN = [move for move in MOVES if not move.procedures]


def flange(place: StatedPlace) -> RigidTransform:
    if place.base_T_flange is not None:
        return place.base_T_flange
    return SCENE.arms["arm"].base_T_flange(place.joints_rad)


def at(label: str) -> RigidTransform:
    """``base_T_flange`` at the place of this label."""
    return next(
        flange(place) for move in MOVES for place in (move.start, move.end) if place.label == label
    )


def stated(command: dict[str, Any]) -> bool:
    return any(covers(SCENE, move, command, PLACED_M) for move in MOVES)


def test_every_commanded_move_was_stated() -> None:
    assert MOTIONS
    assert [motion for motion in MOTIONS if not stated(motion)] == []


def test_a_move_that_nobody_stated_is_noticed() -> None:
    strange = {"what": "move_linear", "base_T_flange_mm_deg": [500.0, 100.0, 420.0, 0, 0, 180]}
    assert not stated(strange)


def test_the_plug_comes_to_its_seat_along_the_axis_of_the_socket() -> None:
    socket = read_drawings(RECIPE, ANTENNA.parent).socket
    flange_T_plug = pose_from_xyzabc(RECIPE.flange_T_plug) * connector_T_plug(socket)
    base_T_socket = pose_from_xyzabc(RECIPE.base_T_socket.pose)
    seated = base_T_socket.inv() * at("seat") * flange_T_plug
    assert np.abs(np.concatenate(pose_error(RigidTransform.identity(), seated))).max() < 1e-9
    up = base_T_socket.inv() * at("stand-off") * flange_T_plug
    assert up.translation / MM == pytest.approx([0.0, 0.0, 2.5 + 3.0], abs=1e-6)
    clear = base_T_socket.inv() * at("clear of the socket") * flange_T_plug
    assert clear.translation[2] > up.translation[2]


def test_what_is_low_at_tray_or_socket_leaves_it_straight_up_before_it_goes_home() -> None:
    for low in ("grip", "seat", "stand-off"):
        assert not [move for move in MOVES if move.start.label == low and move.end.label == "home"]
        clear = {
            move.end.label
            for move in MOVES
            if move.start.label == low and move.approach and move.kind is MoveKind.LINEAR
        }
        home = {move.start.label for move in MOVES if move.end.label == "home"}
        assert clear & home, low


def test_home_is_stated_from_the_end_and_the_middle_of_every_free_move() -> None:
    starts = {move.start.label for move in MOVES if move.end.label == "home"}
    for move in MOVES:
        if move.approach or move.end.label == "home":
            continue
        assert move.end.label in starts
        assert f"half way to {move.end.label} from {move.start.label}" in starts


@pytest.mark.parametrize("move", OF_RUN, ids=lambda move: move.name)
@pytest.mark.long
def test_every_move_of_a_run_in_the_shipped_cell_is_free(move: StatedMove) -> None:
    checked = check_move(SCENE, move)
    assert checked.fault is None, str(checked.fault)


@pytest.mark.parametrize("name", ["above the tray", "over the socket", "seat"])
def test_the_way_down_is_free_in_the_shipped_cell(name: str) -> None:
    moves = [move for move in OF_RUN if move.approach and move.end.label == name]
    assert moves
    for move in moves:
        checked = check_move(SCENE, move)
        assert checked.fault is None, str(checked.fault)


def test_the_board_on_the_flange_would_meet_a_plate_that_nobody_took_away() -> None:
    """What the model says with ``absent_in``: procedures 202 and 204 need the plate off."""
    (plate,) = [solid for solid in SCENE.solids if solid.name == "plate"]
    assert plate.absent_in == {202, 204}
    (swing,) = [
        move
        for move in MOVES
        if (move.start.label, move.end.label) == ("board_show, view 8", "board_show, view 9")
    ]
    assert swing.procedures == {202, 204}
    assert check_move(SCENE, swing).fault is None
    there = replace(SCENE, solids=tuple(replace(s, absent_in=frozenset()) for s in SCENE.solids))
    assert "plate" in str(check_move(there, swing).fault)
