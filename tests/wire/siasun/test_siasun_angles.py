"""The order of angles that a hello names, in what the driver reads and in what it writes."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.link import VersionMismatch
from tests.rigs.wire.job_rig import JobRig, job_rig
from tests.rigs.wire.siasun_angles import EULERS, rotation_by_hand
from tests.rigs.wire.siasun_cell import running
from tests.rigs.wire.sjl_rig import Rig, sjl_rig
from tests.wire.siasun.test_siasun_kinematics import config_of

ABC_DEG = [
    (90.0, 0.0, 180.0),
    (10.0, -20.0, 30.0),
    # At both poles of the Euler orders, and beside them.
    (40.0, 90.0, -15.0),
    (40.0, -90.0, 15.0),
    (-120.0, 89.999, 60.0),
    (0.0, 0.0, 0.0),
]
LAST_DIGIT_RAD = np.radians(3e-4)
"""Three angles with four decimals of a degree, each off by at most one in the last."""


def as_text(rotation_deg: tuple[float, float, float]) -> str:
    return ",".join(f"{value:.4f}" for value in (1900.0, 0.0, 930.0, *rotation_deg))


@pytest.mark.parametrize("euler", EULERS)
@pytest.mark.parametrize("abc_deg", ABC_DEG)
async def test_a_reported_pose_is_read(euler: str, abc_deg: tuple[float, float, float]) -> None:
    async with running(euler=euler, pose=as_text(abc_deg)) as cell:
        found = cell.robot.state().base_T_flange.rotation
        assert (found.inv() * rotation_by_hand(euler, abc_deg)).magnitude() < 1e-9


@pytest.mark.parametrize("euler", EULERS)
@pytest.mark.parametrize("abc_deg", ABC_DEG)
async def test_a_target_is_written_and_its_arrival_read(
    euler: str, abc_deg: tuple[float, float, float]
) -> None:
    """The target is made in another convention than the controller's, so nothing cancels."""
    rotation = rotation_by_hand("ZYX", abc_deg)
    target = RigidTransform.from_components([1.9, 0.0, 0.93], rotation)
    async with running(euler=euler) as cell:
        moving = cell.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=0.2)
        move = asyncio.create_task(moving)
        fields = (await cell.cmd.expect()).split(",")
        sent = [float(text) for text in fields[3:9]]
        assert sent[:3] == pytest.approx([1900.0, 0.0, 930.0])
        assert (rotation_by_hand(euler, sent[3:]).inv() * rotation).magnitude() < LAST_DIGIT_RAD
        cell.cmd.send("ACK,1")
        pose = ",".join(fields[3:9])
        cell.cmd.send(f"DONE,1,{pose}")
        await cell.report_until(move, pose=pose)
        end = await move
        assert (end.base_T_flange.rotation.inv() * rotation).magnitude() < LAST_DIGIT_RAD


async def test_each_channel_has_the_order_of_its_own_hello() -> None:
    """Two jobs of one controller are two files, and somebody may change one of them only."""
    async with running(euler="XYZ", pose=as_text((10.0, -20.0, 30.0))) as cell:
        port = cell.robot._config.command_port
        await cell.back(port)
        assert cell.robot._command.channel.hello.euler == "ZYX"
        found = cell.robot.state().base_T_flange.rotation
        by_hand = Rotation.from_euler("XYZ", [30.0, -20.0, 10.0], degrees=True)
        assert (found.inv() * by_hand).magnitude() < 1e-9


@pytest.mark.parametrize("make", [sjl_rig, job_rig], ids=["records", "jobs"])
async def test_a_hello_that_names_another_order_than_the_controller_has_is_found(
    make: Callable[..., AbstractAsyncContextManager[Rig | JobRig]],
) -> None:
    async with make(dh=config_of("main").dh) as rig:
        rig.controller.faults.inject("other_euler")
        with pytest.raises(VersionMismatch, match="order of angles"):
            await rig.connect()
        rig.controller.faults.clear()
        await rig.connect()
