"""Every procedure begins with main robot and heads where nothing is in the way."""

from typing import Any

import numpy as np
import pytest
from cellctl.procedures.clear_cell import clear_the_cell
from cellctl.runtime.step import Step

from cellctl.runtime.job import HeldMeanwhile
from cellctl.runtime.maintenance import PROCEDURES
from tests.unit.procedures.rig import ProcedureRig


class Log:
    """In which order the robots were moved, and where to."""

    def __init__(self, rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch) -> None:
        self.moves: list[tuple[str, tuple[float, ...]]] = []
        for robot in rig.bench.cell.robots:
            monkeypatch.setattr(robot, "move_joint", self._logged(robot.name, robot.move_joint))

    def _logged(self, name: str, move: Any) -> Any:
        async def move_joint(joints_rad: Any, *, speed_ratio: float) -> Any:
            self.moves.append((name, tuple(np.degrees(joints_rad).round(5))))
            return await move(joints_rad, speed_ratio=speed_ratio)

        return move_joint


@pytest.fixture
def log(rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch) -> Log:
    return Log(rig, monkeypatch)


async def test_main_robot_first_then_heads_back_then_the_one_that_measures(
    rig: ProcedureRig, log: Log
) -> None:
    robots = rig.bench.cell.config.robots
    await clear_the_cell(rig.context, measuring=rig.bench.cell.head_2)
    assert log.moves == [
        ("main", robots.main.home_joints_deg),
        ("aux_1", robots.aux_1.retracted_joints_deg),
        ("aux_2", robots.aux_2.measuring_joints_deg),
    ]
    await clear_the_cell(rig.context, measuring=rig.bench.cell.head_2)
    assert len(log.moves) == 3, "who is there already does not move"


@pytest.mark.parametrize(
    ("number", "first_head", "second_head"),
    [
        (Step.CALIBRATE_HEAD_1, "measuring", "retracted"),
        (Step.CALIBRATE_HEAD_2, "retracted", "measuring"),
        (Step.CALIBRATE_BASE_FRAME, "retracted", "retracted"),
        (Step.CALIBRATE_BOARD_1, "measuring", "retracted"),
        (Step.CALIBRATE_BOARD_2, "retracted", "measuring"),
        (Step.IDENTIFY_PAYLOAD, "retracted", "retracted"),
        (Step.MEASURE_STOP_LATENCY, "retracted", "retracted"),
    ],
)
async def test_before_its_first_safe_point_each_procedure_has_cleared_the_cell(
    rig: ProcedureRig, number: Step, first_head: str, second_head: str
) -> None:
    rig.pauses._held_at = (1,)
    cell = rig.bench.cell
    with pytest.raises(HeldMeanwhile):
        await PROCEDURES[number](rig.context)
    home = np.radians(cell.config.robots.main.home_joints_deg)
    np.testing.assert_allclose(cell.main.moves[0].target, home)
    for head, where in zip(cell.heads, (first_head, second_head), strict=True):
        joints_deg = getattr(head.config, f"{where}_joints_deg")
        np.testing.assert_allclose(head.robot.state().joints_rad, np.radians(joints_deg))
