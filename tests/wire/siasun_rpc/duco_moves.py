"""Motions on the rig of a collaborative arm, as tests need them."""

import asyncio

from scipy.spatial.transform import RigidTransform

from cellctl.errors.link import LinkError
from cellctl.errors.robot import NotRearmed
from cellctl.interfaces.robot import RobotState
from tests.rigs.wire.duco_rig import DucoRig


def up(rig: DucoRig, dz_mm: float) -> RigidTransform:
    here = rig.robot.state().base_T_flange
    return RigidTransform.from_translation([0.0, 0.0, dz_mm / 1000]) * here


def move(rig: DucoRig, dz_mm: float) -> "asyncio.Task[RobotState]":
    job = rig.robot.move_linear(up(rig, dz_mm), speed_m_s=0.08, acceleration_m_s2=1.0)
    return asyncio.create_task(job)


async def begun(rig: DucoRig) -> "asyncio.Task[RobotState]":
    moving = move(rig, 80.0)
    async with asyncio.timeout(2.0):
        while not rig.logic.moving():
            await asyncio.wait({moving}, timeout=0.005)
    return moving


async def stands(rig: DucoRig) -> None:
    async with asyncio.timeout(2.0):
        while rig.logic.moving():  # noqa: ASYNC110 - the arm tells nobody
            await asyncio.sleep(0.005)


async def rearm(rig: DucoRig) -> None:
    async with asyncio.timeout(5.0):
        while True:
            try:
                return await rig.robot.rearm()
            except (LinkError, NotRearmed):
                await asyncio.sleep(0.05)
