"""The zones of the fake cell, with its arms at their taught poses."""

import asyncio

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.zones.zoned_robot import ZonedRobot, ZonedStreamingRobot, zoned_robots
from cellctl.config import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.errors.robot import ZoneTaken
from cellctl.geometry.pose import Array
from cellctl.processes.deck_to_frame.settings import DeckSettings
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE
from tests.unit.cell.robots import StillRobot


@pytest.fixture(scope="module")
def config() -> CellConfig:
    return shipped_cell(CELL_FILE.name)


class Arms:
    """Arms that arrive at once, each standing where its joints have it."""

    def __init__(self, config: CellConfig, **poses: str) -> None:
        self.config = config
        self.still = {name: StillRobot(name) for name in config.robots}
        self.zoned = zoned_robots(config, self.still)
        for name, pose in poses.items():
            self.stand(name, self.taught(name, pose))

    def taught(self, name: str, pose: str) -> Array:
        return np.radians(self.config.robots[name].poses_deg[pose])

    def stand(self, name: str, joints_rad: Array) -> None:
        driver, settings = robot_driver(self.config.robots[name])
        kinematics = driver.forward_kinematics(settings)
        assert kinematics is not None
        robot = self.still[name]
        robot.joints_rad, robot.flange = joints_rad, kinematics(joints_rad)

    async def go(self, name: str, joints_rad: Array) -> None:
        await self.zoned[name].move_joint(joints_rad, speed_ratio=0.2)
        self.stand(name, joints_rad)


def swung(config: CellConfig, side: float) -> Array:
    """The end of the turn about A1 in procedure 103."""
    settings = config.processes["deck-to-frame"]
    assert isinstance(settings, DeckSettings)
    turn_deg = side * settings.circle_arc_deg / 2 * np.eye(6)[0]
    joints_rad: Array = np.radians(np.array(settings.base_frame_joints_deg) + turn_deg)
    return joints_rad


async def test_the_moves_of_an_assembly_and_the_heads_are_free(config: CellConfig) -> None:
    arms = Arms(config, main="home", aux_1="retracted", aux_2="retracted")
    await asyncio.gather(
        *(arms.go(name, arms.taught(name, "measuring")) for name in ("aux_1", "aux_2"))
    )
    for pose in ("deck_measure", "home"):
        await arms.go("main", arms.taught("main", pose))


@pytest.mark.parametrize(("side", "head"), [(-1.0, "aux_1"), (1.0, "aux_2")])
async def test_the_main_arm_swings_only_past_a_retracted_head(
    config: CellConfig, side: float, head: str
) -> None:
    arms = Arms(config, main="home", aux_1="retracted", aux_2="retracted")
    arms.stand(head, arms.taught(head, "measuring"))
    with pytest.raises(ZoneTaken, match=f"{head} stands in it"):
        await arms.go("main", swung(config, side))
    assert not arms.still["main"].moves
    await arms.go("main", swung(config, -side))
    await arms.go("main", arms.taught("main", "home"))
    await arms.go(head, arms.taught(head, "retracted"))
    await arms.go("main", swung(config, side))


async def test_a_head_does_not_come_out_beside_a_main_arm_that_has_swung(
    config: CellConfig,
) -> None:
    # This is the state after an abort in procedure 103: only the reports say where the arms are.
    arms = Arms(config, main="home", aux_1="retracted", aux_2="retracted")
    arms.stand("main", swung(config, -1.0))
    with pytest.raises(ZoneTaken, match="main stands in it"):
        await arms.go("aux_1", arms.taught("aux_1", "measuring"))
    assert not arms.still["aux_1"].moves
    await arms.go("aux_2", arms.taught("aux_2", "measuring"))


async def test_a_main_arm_and_a_head_in_one_zone_leave_in_the_order_of_the_cell_file(
    config: CellConfig,
) -> None:
    """After an abort and a jog at a panel the main arm leaves first, then the head."""
    arms = Arms(config, main="home", aux_1="measuring", aux_2="retracted")
    arms.stand("main", swung(config, -1.0))
    with pytest.raises(ZoneTaken, match="main stands in it"):
        await arms.go("aux_1", arms.taught("aux_1", "measuring") + 0.01)
    await arms.go("main", arms.taught("main", "home"))
    await arms.go("aux_1", arms.taught("aux_1", "retracted"))


async def test_to_the_side_beside_a_head_is_no_way_out(config: CellConfig) -> None:
    """1.2 m past the head, with 30 mm of gain towards the way out, which ends beyond it."""
    arms = Arms(config, main="home", aux_1="retracted", aux_2="measuring")
    arms.still["main"].flange = RigidTransform.from_translation([1.0, 0.08, 1.4])
    speed = {"speed_m_s": 0.05, "acceleration_m_s2": 0.2}
    past_head = RigidTransform.from_translation([2.2, 0.05, 1.4])
    with pytest.raises(ZoneTaken, match="aux_2 stands in it"):
        await arms.zoned["main"].move_linear(past_head, **speed)
    assert not arms.still["main"].moves
    out = RigidTransform.from_translation([1.0, 0.05, 1.4])
    await arms.zoned["main"].move_linear(out, **speed)


def test_the_robots_of_a_cell_ask_the_arbiter(config: CellConfig) -> None:
    cell = Cell(config, CELL_FILE.parent)
    cell.workers.close()
    assert all(isinstance(robot, ZonedStreamingRobot) for robot in cell.robots.values())
    without = Cell(config.model_copy(update={"zones": {}}), CELL_FILE.parent)
    without.workers.close()
    assert not any(isinstance(robot, ZonedRobot) for robot in without.robots.values())
