"""The guard's stop channel against a scripted peer and against the fake controller."""

import asyncio
import select
import time
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager

import numpy as np
import pytest

from cellctl.errors.link import (
    ConnectTimeout,
    LinkLost,
    PortInUse,
    ProtocolViolation,
    VersionMismatch,
)
from cellctl.errors.robot import MotionAborted
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces.stop_channel import FlangeState
from drivers.robot.siasun.config import SiasunStopChannelConfig
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from tests.rigs.wire.job_rig import JobRig, job_rig
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.siasun_angles import rotation_by_hand
from tests.rigs.wire.siasun_peer import POSE, Peer
from tests.rigs.wire.sjl_rig import Rig, sjl_rig


def config(timeout_s: float = 2.0) -> SiasunStopChannelConfig:
    return SiasunStopChannelConfig(
        robot_name="SR500A", guard_port=free_ports(1)[0], connect_timeout_s=timeout_s
    )


@asynccontextmanager
async def guard_of(rig: Rig | JobRig) -> AsyncIterator[SiasunStopChannel]:
    """The guard's channel beside the robot's own two; the controller calls on all of them."""
    channel = SiasunStopChannel(rig.guard)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    await rig.connect()
    await opening
    try:
        yield channel
    finally:
        channel.close()


@pytest.fixture
async def pair() -> AsyncIterator[tuple[SiasunStopChannel, Peer]]:
    settings = config()
    channel = SiasunStopChannel(settings)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    peer = await Peer.greeted(settings.guard_port, "GRD")
    await opening
    yield channel, peer
    channel.close()
    await peer.close()


async def polled(channel: SiasunStopChannel, until_s: float = 1.0) -> FlangeState:
    """The next report; waits for the descriptor as the guard does."""
    deadline_s = time.monotonic() + until_s
    while (state := channel.poll()) is None:
        left_s = deadline_s - time.monotonic()
        readable, _, _ = await asyncio.to_thread(
            select.select, [channel.fileno()], [], [], max(left_s, 0.0)
        )
        assert readable, "no report in time"
    return state


async def test_reports(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    assert channel.poll() is None
    peer.stat("REM,0,1,1,0,0,100")
    state = await polled(channel)
    expected = pose_from_xyzabc([1900.0, -0.125, 927.0, 90.0, 0.0, 180.0])
    assert state.position_m == pytest.approx(tuple(expected.translation))
    assert np.reshape(state.rotation, (3, 3)) == pytest.approx(expected.rotation.as_matrix())
    assert state.moving
    assert not state.stop_latched
    assert abs(state.time_s - time.monotonic()) < 0.5


async def test_only_the_newest_report_counts(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    for _ in range(5):
        peer.stat()
    peer.stat("REM,0,1,0,1,0,100")
    peer.send(f"STOPD,1,{POSE}")
    await peer.writer.drain()
    states: list[FlangeState] = []
    while not (states and states[-1].stop_latched):
        states.append(await polled(channel))
    assert len(states) <= 6


async def test_a_repeated_report_is_no_news(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    peer.stat()
    await polled(channel)
    peer.count -= 1
    peer.stat()
    await asyncio.to_thread(select.select, [channel], [], [], 1.0)
    assert channel.poll() is None


async def test_stop_and_heartbeat(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    channel.heartbeat()
    channel.request_stop()
    channel.request_stop()
    channel.heartbeat()
    session = peer.session
    assert [await peer.expect() for _ in range(4)] == [
        f"BEAT,{session},1",
        f"ABORT,{session},1",
        f"ABORT,{session},2",
        f"BEAT,{session},2",
    ]


@pytest.mark.parametrize("body", ["ACK,1", "HELLO,SJL,2", "NOISE"])
async def test_violation(pair: tuple[SiasunStopChannel, Peer], body: str) -> None:
    channel, peer = pair
    peer.send(body)
    with pytest.raises(ProtocolViolation):
        await polled(channel)
    assert channel.fileno() == -1
    await peer.closed()


async def test_link_lost(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    await peer.close()
    with pytest.raises(LinkLost):
        await polled(channel)
    for act in (channel.poll, channel.request_stop, channel.heartbeat):
        with pytest.raises(LinkLost):
            act()
    channel.close()


async def test_open_again_is_a_new_session(pair: tuple[SiasunStopChannel, Peer]) -> None:
    channel, peer = pair
    channel.close()
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    again = await Peer.greeted(channel._config.guard_port, "GRD")
    await opening
    assert int(again.session) == int(peer.session) % 999_999 + 1
    channel.request_stop()
    assert await again.expect() == f"ABORT,{again.session},1"
    await again.close()


def test_nobody_comes() -> None:
    with pytest.raises(ConnectTimeout):
        SiasunStopChannel(config(0.05)).open()


async def test_port_in_use(pair: tuple[SiasunStopChannel, Peer]) -> None:
    settings = config()
    async with await asyncio.start_server(lambda r, w: None, "127.0.0.1", settings.guard_port):
        with pytest.raises(PortInUse):
            SiasunStopChannel(settings).open()


async def test_wrong_robot() -> None:
    settings = config()
    channel = SiasunStopChannel(settings)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    peer = await Peer.connect(settings.guard_port)
    assert await peer.hello("GRD", "T90A-1") == "NO,HELLO,NAME"
    with pytest.raises(VersionMismatch):
        await opening
    await peer.close()


async def test_an_impostor_on_the_port_of_the_guard_is_refused_and_named() -> None:
    settings = config(0.5).model_copy(update={"robot_address": "127.0.0.2"})
    channel = SiasunStopChannel(settings)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    impostor = await Peer.connect(settings.guard_port)
    await impostor.closed()
    await impostor.close()
    with pytest.raises(ConnectTimeout, match=r"refused: 127\.0\.0\.1"):
        await opening
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    peer = await Peer.connect(settings.guard_port, "127.0.0.2")
    await peer.hello("GRD")
    await opening
    channel.close()
    await peer.close()


async def test_a_stranger_does_not_block_the_robot() -> None:
    settings = config()
    channel = SiasunStopChannel(settings)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    stranger = await Peer.connect(settings.guard_port)
    stranger.writer.write(b"\x16\x03\x01\n")
    await stranger.closed()
    await stranger.close()
    peer = await Peer.greeted(settings.guard_port, "GRD")
    await opening
    channel.close()
    await peer.close()


@pytest.mark.parametrize("euler", ["ZYX", "XYZ", "ROTVEC"])
@pytest.mark.parametrize(
    "abc",
    [
        (90.0, 0.0, 180.0),
        (10.0, -20.0, 30.0),
        (-170.0, 89.0, 5.0),
        # At the poles of both Euler orders.
        (40.0, 90.0, -15.0),
        (40.0, -90.0, 15.0),
    ],
)
async def test_angles_are_read_in_the_order_that_the_hello_names(
    euler: str, abc: tuple[float, float, float]
) -> None:
    settings = config()
    channel = SiasunStopChannel(settings)
    opening = asyncio.create_task(asyncio.to_thread(channel.open))
    peer = await Peer.connect(settings.guard_port)
    await peer.hello("GRD", eul=euler)
    await opening
    peer.stat(pose="1900.0000,0.0000,900.0000," + ",".join(f"{angle:.4f}" for angle in abc))
    state = await polled(channel)
    expected = rotation_by_hand(euler, abc).as_matrix()
    assert np.reshape(state.rotation, (3, 3)) == pytest.approx(expected)
    channel.close()
    await peer.close()


@pytest.mark.parametrize("make", [sjl_rig, job_rig], ids=["records", "jobs"])
async def test_the_guard_stops_the_fake_controller(
    make: Callable[..., AbstractAsyncContextManager[Rig | JobRig]],
) -> None:
    async with make(channels=("CMD", "STA", "GRD")) as rig, guard_of(rig) as channel:
        here = rig.robot.state().base_T_flange
        moving = asyncio.create_task(
            rig.robot.move_linear(
                pose_from_xyzabc([0, 0, 100, 0, 0, 0]) * here,
                speed_m_s=0.05,
                acceleration_m_s2=1.0,
            )
        )
        while not (await polled(channel)).moving:
            channel.heartbeat()
        channel.request_stop()
        while not (state := await polled(channel)).stop_latched or state.moving:
            channel.heartbeat()
        with pytest.raises(MotionAborted, match="STOP"):
            await moving


@pytest.mark.parametrize("make", [sjl_rig, job_rig], ids=["records", "jobs"])
async def test_the_death_of_the_guard_stops_the_fake_controller(
    make: Callable[..., AbstractAsyncContextManager[Rig | JobRig]],
) -> None:
    async with make(channels=("CMD", "STA", "GRD")) as rig, guard_of(rig):
        here = rig.robot.state().base_T_flange
        target = pose_from_xyzabc([0, 0, 100, 0, 0, 0]) * here
        moving = rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
        async with asyncio.timeout(2.0):
            with pytest.raises(MotionAborted, match="DEADMAN"):
                await moving


async def test_repeated_stops_do_not_pile_up_before_a_slow_interpreter() -> None:
    """Each would be a stop of its own, and those that are read late one after the release."""
    async with (
        job_rig(channels=("CMD", "STA", "GRD"), statement_s=0.001) as rig,
        guard_of(rig) as channel,
    ):
        states: list[FlangeState] = []
        wanted = True

        async def guard() -> None:
            """Every 20 ms, as the guard does: beat, and repeat until the robot has latched."""
            nonlocal wanted
            while True:
                if state := channel.poll():
                    states.append(state)
                    wanted = wanted and not state.stop_latched
                if wanted:
                    channel.repeat_stop()
                channel.heartbeat()
                await asyncio.sleep(0.02)

        channel.request_stop()
        beating = asyncio.create_task(guard())
        async with asyncio.timeout(5.0):
            while wanted:  # noqa: ASYNC110  the channel has no event
                await asyncio.sleep(0.01)
            await rig.robot.rearm()
            known = len(states)
            while len(states) < known + 6:  # noqa: ASYNC110  likewise
                await asyncio.sleep(0.01)
        beating.cancel()
        # The first of them may be as old as the release.
        assert not any(state.stop_latched for state in states[known + 1 :])
        assert rig.controller.memory.numbers["I", 62] == 1


async def test_a_stop_that_was_overheard_is_repeated() -> None:
    async with job_rig(channels=("CMD", "STA", "GRD")) as rig, guard_of(rig) as channel:
        rig.controller.faults.inject("ignore_stop", count=1)
        channel.request_stop()
        async with asyncio.timeout(3.0):
            while not ((state := channel.poll()) and state.stop_latched):
                channel.heartbeat()
                channel.repeat_stop()
                await asyncio.sleep(0.02)
        assert rig.controller.faults.active("ignore_stop") is None
