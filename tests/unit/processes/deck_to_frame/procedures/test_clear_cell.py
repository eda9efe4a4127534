"""Every procedure begins with main robot and heads where nothing is in the way."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.processes.deck_to_frame.procedures.clear_cell import clear_the_cell
from cellctl.runtime.steps import HeldMeanwhile
from tests.unit.cell.bench import make_bench
from tests.unit.procedures.rig import ProcedureRig


class Log:
    """Keeps in which order the robots were moved, and where to."""

    def __init__(self, rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch) -> None:
        self.moves: list[tuple[str, tuple[float, ...]]] = []
        for robot in rig.bench.cell.robots.values():
            monkeypatch.setattr(robot, "move_joint", self._logged(robot.name, robot.move_joint))

    def _logged(self, name: str, move: Any) -> Any:
        async def move_joint(joints_rad: Any, *, speed_ratio: float) -> Any:
            self.moves.append((name, tuple(np.degrees(joints_rad).round(5))))
            return await move(joints_rad, speed_ratio=speed_ratio)

        return move_joint


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[ProcedureRig]:
    rig = ProcedureRig(make_bench(tmp_path), tmp_path / "store")
    yield rig
    rig.archive.close()


@pytest.fixture
def log(rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch) -> Log:
    return Log(rig, monkeypatch)


async def test_main_robot_first_then_heads_back_then_the_one_that_measures(
    rig: ProcedureRig, log: Log
) -> None:
    robots, deck = rig.bench.cell.config.robots, rig.bench.deck
    await clear_the_cell(deck, rig.board, measuring=deck.head_2)
    assert log.moves == [
        ("main", robots["main"].poses_deg["home"]),
        ("aux_1", robots["aux_1"].poses_deg["retracted"]),
        ("aux_2", robots["aux_2"].poses_deg["measuring"]),
    ]
    await clear_the_cell(deck, rig.board, measuring=deck.head_2)
    assert len(log.moves) == 3, "who is there already does not move"


@pytest.mark.parametrize(
    ("number", "first_head", "second_head"),
    [
        (101, "measuring", "retracted"),
        (102, "retracted", "measuring"),
        (103, "retracted", "retracted"),
        (104, "measuring", "retracted"),
        (105, "retracted", "measuring"),
        (106, "retracted", "retracted"),
        (107, "retracted", "retracted"),
    ],
)
async def test_before_its_first_safe_point_each_procedure_has_cleared_the_cell(
    rig: ProcedureRig, number: int, first_head: str, second_head: str
) -> None:
    rig.pauses._held_at = (1,)
    cell = rig.bench.cell
    with pytest.raises(HeldMeanwhile):
        await rig.procedures[number].run(rig.context)
    home = np.radians(cell.config.robots["main"].poses_deg["home"])
    np.testing.assert_allclose(cell.main.moves[0].target, home)
    for head, where in zip(cell.heads, (first_head, second_head), strict=True):
        joints_deg = head.config.poses_deg[where]
        np.testing.assert_allclose(head.robot.state().joints_rad, np.radians(joints_deg))
