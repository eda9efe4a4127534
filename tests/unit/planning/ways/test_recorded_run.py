"""What a run of the fake cell commanded (the commands of its motion.mcap) is what was stated."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.planning.ways.check_moves import stated_moves
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()
MOVES = list(stated_moves(SCENE.cell))
RECORD = Path("tests/data/motion/deck-run.jsonl")
COMMANDS = [json.loads(line) for line in RECORD.read_text(encoding="utf-8").splitlines()]
STATION_M = SCENE.cell.recipes[0].model_dump()["station_tolerance_mm"] * MM
"""The frame may stand so far from where the recipe has it, and the deck as far in the gripper."""


def flange(robot: str, place: StatedPlace) -> RigidTransform:
    if place.base_T_flange is not None:
        return place.base_T_flange
    return SCENE.arms[robot].base_T_flange(place.joints_rad)


def off_line_m(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    way = end - start
    length = float(way @ way)
    # A tilt turns the flange about its own place.
    share = np.clip((point - start) @ way / length, 0.0, 1.0) if length else 0.0
    return float(np.linalg.norm(point - start - share * way))


def covers(move: StatedMove, command: dict[str, Any]) -> bool:
    """Whether the target is one of the move, or between its ends, to the tolerance of the parts."""
    if command["what"] == "move_joint":
        ends = move.end.joints_rad
        return move.kind is MoveKind.JOINT and bool(
            np.abs(ends - np.array(command["joints_rad"])).max() < 1e-6
        )
    if move.kind is not MoveKind.LINEAR:
        return False
    target_m = pose_from_xyzabc(command["base_T_flange_mm_deg"]).translation
    start, end = (flange(move.robot, place).translation for place in (move.start, move.end))
    return bool(off_line_m(target_m, start, end) <= STATION_M)


def motions() -> list[dict[str, Any]]:
    return [one for one in COMMANDS if one["what"] in ("move_joint", "move_linear", "step")]


def test_the_record_is_that_of_a_whole_run() -> None:
    assert {one["robot"] for one in motions()} == {"main", "aux_1", "aux_2"}
    assert {one["what"] for one in motions()} == {"move_joint", "move_linear", "step"}


@pytest.mark.parametrize("number", range(len(motions())))
def test_every_commanded_move_was_stated(number: int) -> None:
    command = motions()[number]
    assert any(covers(move, command) for move in MOVES if move.robot == command["robot"]), command


def test_a_move_that_nobody_stated_is_noticed() -> None:
    strange = {"what": "move_linear", "base_T_flange_mm_deg": [1900.0, 40.0, 1400.0, 90, 0, 180]}
    assert not any(covers(move, strange) for move in MOVES if move.robot == "main")
