"""What a run of the fake cell commanded (the commands of its motion.mcap) is what was stated."""

from pathlib import Path
from typing import Any

import pytest

from cellctl.geometry.pose import MM
from cellctl.planning.ways.check_moves import stated_moves
from tests.unit.planning.deck_cell import deck_scene
from tests.unit.planning.ways.recorded_moves import covers, motions

SCENE = deck_scene()
MOVES = list(stated_moves(SCENE))
MOTIONS = motions(Path("tests/data/motion/deck-run.jsonl"))
STATION_M = SCENE.cell.recipes[0].model_dump()["station_tolerance_mm"] * MM
"""The frame may stand so far from where the recipe has it, and the deck as far in the gripper."""


def stated(command: dict[str, Any]) -> bool:
    return any(
        covers(SCENE, move, command, STATION_M) for move in MOVES if move.robot == command["robot"]
    )


def test_the_record_is_that_of_a_whole_run() -> None:
    assert {one["robot"] for one in MOTIONS} == {"main", "aux_1", "aux_2"}
    assert {one["what"] for one in MOTIONS} == {"move_joint", "move_linear", "step"}


@pytest.mark.parametrize("number", range(len(MOTIONS)))
def test_every_commanded_move_was_stated(number: int) -> None:
    assert stated(MOTIONS[number]), MOTIONS[number]


def test_a_move_that_nobody_stated_is_noticed() -> None:
    strange = {"what": "move_linear", "base_T_flange_mm_deg": [1900.0, 40.0, 1400.0, 90, 0, 180]}
    assert not stated({"robot": "main", **strange})
