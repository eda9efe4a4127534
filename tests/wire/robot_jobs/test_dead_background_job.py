"""An alarm ends a background job while the arm moves, and with it dead man and contact DO[9]."""

import asyncio
import time
from collections.abc import AsyncIterator

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.robot_layers.permitted_robot import PermittedRobot
from cellctl.errors.link import LinkLost
from cellctl.interfaces import Robot, RobotState
from tests.rigs.wire.job_rig import JobRig, job_rig
from tests.rigs.wire.permit_loop import PERMIT, permit_loop

WATCHDOG_MS = 300
STANDS_S = 0.5
"""Time from the alarm: to see the link go, the contact, 0.25 s dead time, and braking."""


@pytest.fixture
async def rig() -> AsyncIterator[JobRig]:
    async with job_rig() as rig:
        await rig.connect()
        await rig.robot._state.wait(lambda status: not status.latched, 2.0)
        yield rig


async def moving(rig: JobRig, robot: Robot) -> "asyncio.Task[RobotState]":
    up = RigidTransform.from_translation([0.0, 0.0, 0.1])
    target = up * rig.robot.state().base_T_flange
    job = asyncio.create_task(robot.move_linear(target, speed_m_s=0.02, acceleration_m_s2=1.0))
    await rig.robot._state.wait(lambda status: status.moving, 2.0)
    return job


async def until_it_stands(rig: JobRig) -> float:
    """Seconds that it takes."""
    begun_s = time.monotonic()
    async with asyncio.timeout(3.0):
        while rig.controller.moving():  # noqa: ASYNC110  the arm has no event
            await asyncio.sleep(0.005)
    return time.monotonic() - begun_s


async def test_the_arm_stands_by_the_contact_of_the_pc(rig: JobRig) -> None:
    async with permit_loop(rig, watchdog_ms=WATCHDOG_MS) as (io, _):
        job = await moving(rig, PermittedRobot(rig.robot, io, PERMIT))
        rig.let_report_overflow()
        with pytest.raises(LinkLost):
            await job
        assert rig.controller.alarm.startswith("SJLSTA")
        assert await until_it_stands(rig) < STANDS_S
        assert rig.arm.cut_short
        # Nobody on the controller has stopped it: the contact of the job is as it was.
        assert rig.controller.memory.outputs["DO", 9] == 1


async def test_beside_a_dead_pc_it_stands_by_the_watchdog_of_the_coupler(rig: JobRig) -> None:
    async with permit_loop(rig, watchdog_ms=WATCHDOG_MS) as (_, wire):
        job = await moving(rig, rig.robot)
        wire.forth.blocked = True
        rig.let_report_overflow()
        assert await until_it_stands(rig) < STANDS_S + WATCHDOG_MS / 1000
        assert rig.arm.cut_short
        with pytest.raises(LinkLost):
            await job


async def test_without_the_contact_nothing_stops_it(rig: JobRig) -> None:
    """Why `cellctl check` demands the contact; with a controller that stops an arm by the alarm of
    a background job this could go."""
    job = await moving(rig, rig.robot)
    rig.let_report_overflow()
    with pytest.raises(LinkLost):
        await job
    await asyncio.sleep(2 * STANDS_S)
    assert rig.controller.moving()
