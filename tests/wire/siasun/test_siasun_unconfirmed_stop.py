"""A controller that does not obey ABORT: the driver ends every sign of life towards it."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkLost
from cellctl.errors.robot import MotionAborted, NotRearmed, StopFailed
from cellctl.interfaces.robot import RobotState
from tests.rigs.wire.any_rig import AnyRig, Make, move

STOP_S = 0.4


@pytest.fixture
async def rig(make: Make) -> AsyncIterator[AnyRig]:
    async with make(stop_timeout_s=STOP_S) as rig:
        await rig.connect()
        yield rig


def long_move(rig: AnyRig) -> "asyncio.Task[RobotState]":
    return move(rig, 100.0, 0.01)


async def unconfirmed(rig: AnyRig) -> "asyncio.Task[RobotState]":
    """Stop a long move that the controller goes on with; the move."""
    moving = long_move(rig)
    await rig.robot._state.wait(lambda status: status.moving, 2.0)
    rig.controller.faults.inject("ignore_stop")
    with pytest.raises(StopFailed):
        await rig.robot.stop()
    return moving


async def test_no_heartbeat_and_no_link_remain(rig: AnyRig) -> None:
    moving = await unconfirmed(rig)
    sent = rig.robot._state._beats
    async with asyncio.timeout(1.0):
        while rig.arm.moving(rig.controller._clock()):  # noqa: ASYNC110  no event for it
            await asyncio.sleep(0.01)
    # This is longer than the controller waits before it connects again.
    await asyncio.sleep(0.8)
    assert rig.controller.open_channels == []
    assert rig.robot._state._beats == sent
    with pytest.raises(LinkLost):
        rig.robot.state()
    with pytest.raises(CellError):
        await moving


async def test_links_come_back_by_connect_and_the_latch_stays(rig: AnyRig) -> None:
    moving = await unconfirmed(rig)
    with pytest.raises((LinkLost, MotionAborted)):
        await moving
    rig.controller.faults.clear()
    await rig.robot.connect()
    assert rig.robot.state().stop_latched
    with pytest.raises(NotRearmed):
        await long_move(rig)
    await rig.robot.rearm()
    assert not rig.robot.state().stop_latched


async def test_a_second_stop_fails_as_well(rig: AnyRig) -> None:
    moving = await unconfirmed(rig)
    with pytest.raises(StopFailed):
        await rig.robot.stop()
    assert not rig.robot._state.channel.connected
    with pytest.raises(CellError):
        await moving
