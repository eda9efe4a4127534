"""What tests do with a driver on either fake: the one written from the protocol text, and the one
that runs the shipped job files."""

import asyncio
from collections.abc import Awaitable
from contextlib import AbstractAsyncContextManager
from typing import Protocol, TypeVar

from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.interfaces.robot import RobotState
from tests.rigs.wire.job_rig import JobRig
from tests.rigs.wire.sjl_rig import Rig

Value = TypeVar("Value")
AnyRig = Rig | JobRig


class Make(Protocol):
    """Makes a rig with changes to the driver's settings."""

    def __call__(self, **changes: object) -> AbstractAsyncContextManager[AnyRig]: ...


def above(rig: AnyRig, dz_mm: float) -> RigidTransform:
    """A target straight above or below the present pose."""
    here = rig.robot.state().base_T_flange
    return RigidTransform.from_translation([0.0, 0.0, dz_mm / 1000]) * here


def move(rig: AnyRig, dz_mm: float = 20.0, speed_m_s: float = 0.1) -> "asyncio.Task[RobotState]":
    return asyncio.create_task(
        rig.robot.move_linear(above(rig, dz_mm), speed_m_s=speed_m_s, acceleration_m_s2=1.0)
    )


async def until_moving(rig: AnyRig) -> None:
    await rig.robot._state.wait(lambda status: status.moving, 2.0)


async def stands(rig: AnyRig) -> None:
    """Wait until the arm stands: a controller may still brake when its answer has come."""
    async with asyncio.timeout(2.0):
        while rig.controller.moving():  # noqa: ASYNC110  the arm has no event
            await asyncio.sleep(0.01)


async def within(limit_s: float, task: Awaitable[Value]) -> Value:
    async with asyncio.timeout(limit_s):
        return await task


async def rearm(rig: AnyRig) -> None:
    """Re-arm as an operator does: try until the robot's channels are back and it accepts."""
    async with asyncio.timeout(5.0):
        while True:
            try:
                return await rig.robot.rearm()
            except CellError:
                await asyncio.sleep(0.05)
