"""A move that reaches the controller when the daemon is dead and the guard's last stop is past."""

import asyncio
import contextlib
import socket

import pytest

from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel
from tests.rigs.wire.duco_rig import DucoRig, duco_rig
from tests.wire.siasun_rpc.duco_moves import move, stands, up

HEARTBEAT_S = 0.3
"""Of the rig."""
WAY_MM = 80.0
"""At 80 mm/s, so that the whole way takes a second."""
STOP = request("stop", False).data


def killed(rig: DucoRig) -> None:
    """The end of every connection of the daemon, as by SIGKILL: no stop, no farewell."""
    link = rig.robot._link
    link._wanted = False
    link._jobs.cancel()
    for one in (link.motion, link.control, link._asking, link._beating):
        transport, one._transport = one._transport, None
        assert transport is not None
        transport.abort()
    link.up = False


async def test_a_move_that_outlives_its_daemon_is_stopped_by_the_dead_man_it_brings_along() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        guard = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(guard.open)
        target, before = up(rig, WAY_MM), rig.robot.state()
        rig.logic.faults.inject("motion_late", count=1, delay_s=2 * HEARTBEAT_S)
        moving = move(rig, WAY_MM)
        await asyncio.wait({moving}, timeout=0.05)
        killed(rig)
        guard.request_stop()
        guard.close()
        async with asyncio.timeout(3.0):
            while not rig.logic.moving():  # noqa: ASYNC110 - the fake tells nobody
                await asyncio.sleep(0.005)
        begun_s = rig.logic.clock()
        assert rig.logic.stops == 2, "the guard's last ones, before the arm has begun"
        await stands(rig)
        assert rig.arm.cut_short
        assert rig.logic.clock() - begun_s < HEARTBEAT_S + 0.5, "braking included"
        z_mm = 1e3 * rig.logic.pose()[2]
        assert 1e3 * before.base_T_flange.translation[2] < z_mm < 1e3 * target.translation[2] - 20
        moving.cancel()
        await asyncio.gather(moving, return_exceptions=True)


@pytest.mark.parametrize("calls", [1, 2], ids=["cut behind the first beat", "cut behind the move"])
async def test_wherever_the_network_cuts_the_piece_a_heartbeat_is_with_the_move(calls: int) -> None:
    """The rest of the piece is lost; what comes first has come within the dead man's time."""
    async with duco_rig() as rig:
        await rig.robot.connect()
        pose = [float(number) for number in rig.logic.pose()]
        pose[2] += WAY_MM / 1e3
        settings = rig.settings
        far = request(
            "movel", pose, 0.08, 1.0, 0.0, rig.logic.joints(), settings.tool, settings.work_frame,
            False,
        )  # fmt: skip
        piece = rig.robot._link.under_dead_man(far)
        assert [one.method for one in piece] == ["rpc_heartbeat", "movel", "rpc_heartbeat"]
        begin = b"".join(one.data for one in piece[:calls])
        rest = b"".join(one.data for one in piece[calls : calls + 1]) if calls == 1 else b""
        with socket.create_connection(("127.0.0.1", rig.rpc.port)) as line:
            line.sendall(begin)
            await asyncio.sleep(HEARTBEAT_S / 3)
            line.sendall(rest)
            async with asyncio.timeout(2.0):
                while not rig.logic.moving():  # noqa: ASYNC110 - the fake tells nobody
                    await asyncio.sleep(0.005)
            await stands(rig)
        assert rig.arm.cut_short


async def test_an_arm_that_is_moved_longer_than_the_dead_man_is_not_stopped_by_it() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        await move(rig, WAY_MM)
        assert not rig.arm.cut_short


@pytest.mark.parametrize("dies", [True, False])
async def test_what_the_network_has_not_taken_dies_with_the_process(*, dies: bool) -> None:
    listening = socket.create_server(("127.0.0.1", 0))
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection = RpcConnection("arm", lambda _: None, dies_with_process=dies)
    await connection.open("127.0.0.1", listening.getsockname()[1])
    far, _ = listening.accept()
    transport = connection._transport
    assert transport is not None
    # A far end that takes nothing more: what is sent stays in this PC's system.
    near: socket.socket = transport.get_extra_info("socket")._sock
    filler = request("get_last_error").data
    with contextlib.suppress(BlockingIOError):
        while True:
            near.send(filler * 100)
    near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4 * near.getsockopt(1, socket.SO_SNDBUF))
    assert near.send(STOP) == len(STOP)
    transport.abort()
    await asyncio.sleep(0)
    heard = b""
    far.settimeout(2.0)
    with contextlib.suppress(ConnectionResetError):
        while data := far.recv(65536):
            heard += data
    far.close()
    listening.close()
    assert (STOP in heard) is not dies
