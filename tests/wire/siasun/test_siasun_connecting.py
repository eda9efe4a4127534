"""How the SIASUN driver connects, and to whom it does not, against a scripted peer."""

import asyncio

import pytest

from cellctl.errors.link import (
    CallerRefused,
    ConnectTimeout,
    LinkLost,
    PortInUse,
    VersionMismatch,
)
from drivers.robot.siasun.driver import SiasunRobot
from tests.rigs.wire.siasun_cell import config
from tests.rigs.wire.siasun_peer import Peer


async def test_nobody_comes() -> None:
    with pytest.raises(ConnectTimeout, match="SR500A CMD"):
        await SiasunRobot("main", config(connect_timeout_s=0.05)).connect()


async def test_disconnect_ends_a_pending_connect() -> None:
    settings = config()
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    peer = await Peer.greeted(settings.command_port, "CMD")
    await robot.disconnect()
    async with asyncio.timeout(0.5):
        with pytest.raises(LinkLost):
            await connecting
    await peer.close()


async def test_an_impostor_is_refused_and_reported_and_the_robot_is_not_kept_out() -> None:
    settings = config(robot_address="127.0.0.2")
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    for _ in range(2):
        impostor = await Peer.connect(settings.state_port)
        impostor.stat()
        await impostor.closed()
        await impostor.close()
    sta = await Peer.greeted(settings.state_port, "STA", address="127.0.0.2")
    cmd = await Peer.greeted(settings.command_port, "CMD", address="127.0.0.2")
    sta.stat()
    await connecting
    (refused,) = robot.incidents()
    assert isinstance(refused, CallerRefused)
    assert refused.detail == "SR500A STA: 127.0.0.1 called, the robot is 127.0.0.2"
    assert robot.incidents() == ()
    await robot.disconnect()
    for peer in (cmd, sta):
        await peer.close()


async def test_port_in_use() -> None:
    settings = config()
    server = await asyncio.start_server(lambda r, w: None, "127.0.0.1", settings.state_port)
    async with server:
        with pytest.raises(PortInUse):
            await SiasunRobot("main", settings).connect()


@pytest.mark.parametrize(
    ("changes", "reason"),
    [({"version": "9"}, "VERSION"), ({"eul": "ZYZ"}, "CONVENTION"),
     ({"unit": "MRAD"}, "CONVENTION"), ({"robot": "T90A"}, "NAME"),
     ({"deadman": "900"}, "DEADMAN")],
)  # fmt: skip
async def test_mismatch(changes: dict[str, str], reason: str) -> None:
    settings = config()
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    peer = await Peer.connect(settings.command_port)
    assert await peer.hello("CMD", **changes) == f"NO,HELLO,{reason}"
    with pytest.raises(VersionMismatch):
        await connecting
    await peer.closed()
    await peer.close()


async def test_wrong_channel() -> None:
    settings = config()
    connecting = asyncio.create_task(SiasunRobot("main", settings).connect())
    peer = await Peer.connect(settings.command_port)
    assert await peer.hello("STA") == "NO,HELLO,CHANNEL"
    with pytest.raises(VersionMismatch, match="channel STA"):
        await connecting
    await peer.close()


async def test_a_stranger_does_not_block_the_robot() -> None:
    settings = config()
    robot = SiasunRobot("main", settings)
    connecting = asyncio.create_task(robot.connect())
    stranger = await Peer.connect(settings.command_port)
    stranger.writer.write(b"GET / HTTP/1.1\r\n\r\n")
    await stranger.closed()
    await stranger.close()
    cmd = await Peer.greeted(settings.command_port, "CMD")
    sta = await Peer.greeted(settings.state_port, "STA")
    sta.stat()
    await connecting
    await robot.disconnect()
    await cmd.close()
    await sta.close()


async def test_a_restart_can_listen_again_at_once() -> None:
    settings = config()
    for _ in range(2):
        robot = SiasunRobot("main", settings)
        connecting = asyncio.create_task(robot.connect())
        cmd = await Peer.greeted(settings.command_port, "CMD")
        sta = await Peer.greeted(settings.state_port, "STA")
        sta.stat()
        await connecting
        await robot.disconnect()
        await robot.disconnect()
        await cmd.close()
        await sta.close()
