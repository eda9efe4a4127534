"""Lower speeds in Maintenance: moves are held to them, a stream made for more is refused."""

import numpy as np
import pytest

from cellctl.cell.devices import Cell
from cellctl.cell.robot_layers.slowed_robot import (
    MaintenancePace,
    SlowedRobot,
    SlowedStreamingRobot,
)
from cellctl.config.checks.robot_figures import robot_issues
from cellctl.config.devices import MaintenanceSpeeds
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.interfaces import StreamLimits
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from tests.contracts.inprocess.streaming_robot import PERIOD_S, InProcessStreamingRobot
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE
from tests.unit.cell.robots import StillRobot
from tests.unit.daemon_fixtures import bench, rig
from tests.unit.daemon_rig import DaemonRig

__all__ = ["bench", "rig"]

SLOW = MaintenanceSpeeds(speed_percent=10, linear_speed_mm_s=20.0)
PLACE_RAD = np.zeros(6)


async def speeds_of_moves(robot: SlowedRobot, behind: StillRobot) -> list[float]:
    here = behind.state().base_T_flange
    await robot.move_joint(PLACE_RAD, speed_ratio=0.4)
    await robot.move_joint(PLACE_RAD, speed_ratio=0.05)
    await robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=0.1)
    await robot.move_linear(here, speed_m_s=0.008, acceleration_m_s2=0.1)
    await robot.step(here, speed_m_s=0.03)
    return [move.speed for move in behind.moves]


async def test_moves_are_held_to_the_speeds_of_maintenance_and_of_no_other_mode() -> None:
    behind, pace = StillRobot("main"), MaintenancePace()
    robot = SlowedRobot(behind, SLOW, pace)
    assert await speeds_of_moves(robot, behind) == [0.4, 0.05, 0.05, 0.008, 0.03]
    behind.moves.clear()
    pace.in_maintenance = lambda: True
    assert await speeds_of_moves(robot, behind) == [0.1, 0.05, 0.02, 0.008, 0.02]


async def test_a_stream_that_was_made_for_more_is_refused() -> None:
    behind, pace = InProcessStreamingRobot("main"), MaintenancePace(lambda: True)
    await behind.connect()
    await behind.rearm()
    robot = SlowedStreamingRobot(
        behind, MaintenanceSpeeds(speed_percent=10, linear_speed_mm_s=10.0), pace
    )
    fast = StreamLimits(12e-3 * PERIOD_S, 1e-3, 0.03, 0.08, 0.2)
    slow = StreamLimits(9e-3 * PERIOD_S, 1e-3, 0.03, 0.08, 0.2)
    with pytest.raises(TargetOutOfBounds, match=r"up to 12 mm/s in Maintenance, .* allows 10"):
        robot.stream(fast)
    async with robot.stream(slow):
        pass
    pace.in_maintenance = lambda: False
    async with robot.stream(fast):
        pass


def test_the_cell_file_says_so_for_one_robot() -> None:
    config = shipped_cell(CELL_FILE.name)
    main = config.robots["main"].model_copy(update={"in_maintenance": SLOW})
    slower = config.model_copy(update={"robots": {**config.robots, "main": main}})
    cell = Cell(slower, CELL_FILE.parent)
    layers = str(cell.robots["main"].__dict__), str(cell.robots["aux_1"].__dict__)
    assert ["Slowed" in one for one in layers] == [True, False]


def test_maintenance_is_never_the_faster_mode() -> None:
    config = shipped_cell(CELL_FILE.name)
    fast = MaintenanceSpeeds(speed_percent=41, linear_speed_mm_s=51.0)
    main = config.robots["main"].model_copy(update={"in_maintenance": fast})
    robots = {**config.robots, "main": main}
    issues = robot_issues(config.model_copy(update={"robots": robots}), set())
    assert {issue.key: issue.allowed for issue in issues} == {
        "robots.main.in_maintenance.speed_percent": "at most 40",
        "robots.main.in_maintenance.linear_speed_mm_s": "at most 50",
    }


async def test_the_unit_says_in_which_mode_it_is(rig: DaemonRig) -> None:
    pace = rig.bench.cell.pace
    seen = [pace.in_maintenance()]
    for mode in (Mode.MAINTENANCE, Mode.PRODUCTION):
        assert await rig.unit.machine.set_mode(mode) is RejectCode.NONE
        seen.append(pace.in_maintenance())
    assert seen == [False, True, False]
