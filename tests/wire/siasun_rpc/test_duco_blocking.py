"""A call that blocks keeps its connection until the arm stands; a stop needs another one."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable

import pytest

from drivers.robot.siasun_rpc.codec.messages import Value
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel
from drivers.robot.siasun_rpc.vendor import TaskState
from drivers.robot.siasun_rpc.watch import write_pose
from tests.rigs.wire.duco_rig import DucoRig, duco_rig
from tests.wire.siasun_rpc.duco_moves import stands, up


@pytest.fixture
async def rig() -> AsyncIterator[DucoRig]:
    async with duco_rig() as rig:
        await rig.robot.connect()
        yield rig


async def blocking_move(rig: DucoRig) -> "tuple[asyncio.Future[Value], asyncio.Future[Value]]":
    """On the connection for motions: a slow move that blocks it, and behind it a question. The arm
    moves, and the question waits, as one on another connection does not."""
    settings, joints_rad = rig.settings, rig.robot.state().joints_rad.tolist()
    pose = write_pose(up(rig, 80.0), settings.euler)
    frames = (settings.tool, settings.work_frame)
    blocks = True
    move = request("movel", pose, 0.02, 1.0, 0.0, joints_rad, *frames, blocks)
    ended, answer = rig.robot._link.motion.send(move, request("robotmoving"))
    async with asyncio.timeout(2.0):
        while not rig.logic.moving():
            await asyncio.wait({ended}, timeout=0.005)
    assert await rig.robot._link.control.exchange(request("robotmoving"), timeout_s=1.0) == [True]
    assert not ended.done()
    assert not answer.done()
    return ended, answer


async def by_the_driver(rig: DucoRig) -> None:
    await rig.robot.stop()


async def by_the_guard(rig: DucoRig) -> None:
    guard = SiasunRpcStopChannel(rig.guard)
    await asyncio.to_thread(guard.open)
    guard.request_stop()
    await stands(rig)
    guard.close()


@pytest.mark.parametrize("stop", [by_the_driver, by_the_guard])
async def test_a_stop_passes_a_move_that_holds_its_connection(
    rig: DucoRig, stop: Callable[[DucoRig], Awaitable[None]]
) -> None:
    ended, answer = await blocking_move(rig)
    async with asyncio.timeout(2.0):
        await stop(rig)
        assert not rig.logic.moving()
        assert await ended == TaskState.STOPPED
        assert await answer is False
    assert rig.arm.cut_short


async def test_a_stop_behind_the_move_comes_too_late(rig: DucoRig) -> None:
    """Why it needs a connection of its own: on the same one it is read when the arm stands."""
    ended, _ = await blocking_move(rig)
    (late,) = rig.robot._link.motion.send(request("stop", False))
    await asyncio.sleep(0.3)
    assert rig.logic.moving()
    assert not late.done()
    assert rig.logic.stops == 0
    await rig.robot.stop()
    async with asyncio.timeout(2.0):
        assert await ended == TaskState.STOPPED
        await late
