"""Joint moves against the box of the flange: the driver's kinematics beside the fake's."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.link import VersionMismatch
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.arm.chain import ArmChain
from cellctl.interfaces import RobotMode, RobotState
from drivers.robot.siasun.bounds import Bounds
from drivers.robot.siasun.config import SiasunConfig
from drivers.robot.siasun.driver import SiasunRobot
from drivers.robot.siasun.kinematics import arm_chain
from fakes.scenes.load import load
from fakes.world.arm import forward_matrix, nominal_links
from tests.rigs.shipped import shipped_cell
from tests.rigs.wire.sjl_rig import sjl_rig
from tests.rigs.wire.standing_arm import SCENARIO

CELL = SCENARIO.parent / "deck.toml"
ROBOTS = ("main", "aux_1", "aux_2")
HOME = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 90.0])


def config_of(robot: str) -> SiasunConfig:
    return SiasunConfig.model_validate(shipped_cell(CELL.name).robots[robot].settings)


def standing_at(joints_rad: np.ndarray, base_T_flange: RigidTransform) -> RobotState:
    return RobotState(
        time_s=now_s(),
        base_T_flange=base_T_flange,
        joints_rad=joints_rad,
        mode=RobotMode.REMOTE,
        emergency_stop=False,
        drives_on=True,
        moving=False,
        stop_latched=False,
        error_code=0,
        speed_override_ratio=1.0,
    )


def chain_of(robot: str) -> ArmChain:
    chain = arm_chain(config_of(robot))
    assert chain is not None
    return chain


def at_home() -> RobotState:
    return standing_at(HOME, chain_of("main").base_T_flange(HOME))


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_table_of_the_cell_file_is_the_arm_of_the_scenario(robot: str) -> None:
    links = nominal_links(load(SCENARIO).robots[robot].chain_mm)
    for joints_rad in np.random.default_rng(1).uniform(-2.0, 2.0, (20, 6)):
        found = chain_of(robot).base_T_flange(joints_rad).as_matrix()
        np.testing.assert_allclose(found, forward_matrix(links, joints_rad), atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
def test_all_taught_poses_of_the_cell_file_can_be_reached(robot: str) -> None:
    config = config_of(robot)
    poses = [np.radians(pose) for pose in shipped_cell(CELL.name).robots[robot].poses_deg.values()]
    for start in poses:
        state = standing_at(start, chain_of(robot).base_T_flange(start))
        for target in poses:
            Bounds(robot, config).joint_way(state, target)


@pytest.mark.parametrize(
    "target_deg",
    [
        # The joints are within their limits; the flange is 0.9 m too low, or too far aside.
        (0.0, -20.0, 130.0, 0.0, 0.0, 90.0),
        (80.0, -60.0, 90.0, 0.0, 60.0, 90.0),
    ],
)
def test_a_target_outside_the_box_is_refused(target_deg: tuple[float, ...]) -> None:
    bounds, target_rad = Bounds("main", config_of("main")), np.radians(target_deg)
    bounds.joints(target_rad, 0.4)
    with pytest.raises(TargetOutOfBounds, match="on the way"):
        bounds.joint_way(at_home(), target_rad)


def test_a_way_that_leaves_the_box_is_refused_though_both_ends_lie_inside() -> None:
    config = config_of("main")
    here = at_home()
    x_mm, _, z_mm = here.base_T_flange.translation * 1e3
    turned = HOME + np.radians([60.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    narrow = config.model_copy(
        update={
            "joint_workspace_min_mm": (0.0, -2000.0, z_mm - 10.0),
            "joint_workspace_max_mm": (x_mm * 0.9, 2000.0, z_mm + 10.0),
        }
    )
    start = HOME - np.radians([60.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    state = standing_at(start, chain_of("main").base_T_flange(start))
    with pytest.raises(TargetOutOfBounds, match="on the way"):
        Bounds("main", narrow).joint_way(state, turned)
    Bounds("main", narrow).joint_way(state, start)


def test_a_table_that_does_not_fit_the_robot_is_no_check() -> None:
    shifted = RigidTransform.from_translation([0.0, 0.0, 0.01])
    state = at_home()
    state = replace(state, base_T_flange=shifted * state.base_T_flange)
    with pytest.raises(TargetOutOfBounds, match="dh table"):
        Bounds("main", config_of("main")).table_fits(state)


def test_without_a_table_nothing_is_checked_and_the_driver_says_so() -> None:
    config = config_of("main")
    silent = config.model_copy(update={"dh": None})
    Bounds("main", silent).joint_way(at_home(), np.zeros(6))
    assert SiasunRobot.checks_joint_ways(config)
    assert not SiasunRobot.checks_joint_ways(silent)


async def test_nothing_is_sent_for_a_joint_move_that_leaves_the_box() -> None:
    async with sjl_rig(dh=config_of("main").dh) as rig:
        await rig.connect()
        here_rad = rig.robot.state().joints_rad
        a1_rad = np.eye(6)[0]
        with pytest.raises(TargetOutOfBounds, match="on the way"):
            await rig.robot.move_joint(here_rad + 1.4 * a1_rad, speed_ratio=0.5)
        assert not rig.arm.moving(rig.controller._clock())
        assert not rig.robot.state().stop_latched
        await rig.robot.move_joint(here_rad + 0.02 * a1_rad, speed_ratio=0.5)


async def test_another_frame_at_the_pendant_is_found_before_anything_moves() -> None:
    """The frames that a pose counts in are the controller's; the joints count in none."""
    wrong = [list(row) for row in config_of("main").dh or ()]
    wrong[5][1] += 25.0
    async with sjl_rig(dh=wrong) as rig:
        with pytest.raises(VersionMismatch, match=r"25\.00 mm .* another tool or user frame"):
            await rig.connect()
    async with sjl_rig(dh=config_of("main").dh) as rig:
        await rig.connect()
        rig.robot._bounds = Bounds("main", rig.settings.model_copy(update={"dh": wrong}))
        here = rig.robot.state().base_T_flange
        with pytest.raises(TargetOutOfBounds, match="tool or user frame"):
            await rig.robot.move_linear(here, speed_m_s=0.01, acceleration_m_s2=0.1)
        assert not rig.robot.state().stop_latched
