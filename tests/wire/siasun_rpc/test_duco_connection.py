"""One connection to the service: order of replies, and what ends it."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from thrift.Thrift import TType

from cellctl.errors.link import LinkError, LinkLost, ProtocolViolation, ReplyTimeout
from drivers.robot.siasun_rpc.codec.messages import MethodUnknown
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.protocol import request
from fakes.wire.duco.codec import write_reply, write_unknown
from tests.rigs.wire.duco_rig import duco_rig

MOVING, STOP = request("robotmoving"), request("stop", False)
YES, NO = (write_reply("robotmoving", TType.BOOL, value) for value in (True, False))
FOUR = write_reply("stop", TType.I32, 4)


class Far:
    """The far end: says what it is told to, and keeps what it hears."""

    def __init__(self, writer: asyncio.StreamWriter) -> None:
        self.say = writer.write
        self.hang_up = writer.close


@asynccontextmanager
async def line() -> AsyncIterator[tuple[RpcConnection, Far, list[LinkError]]]:
    """A connection, its far end, and the losses that it tells of."""
    accepted: asyncio.Future[asyncio.StreamWriter] = asyncio.get_running_loop().create_future()
    server = await asyncio.start_server(
        lambda _, writer: accepted.set_result(writer), "127.0.0.1", 0
    )
    lost: list[LinkError] = []
    connection = RpcConnection("arm", lost.append)
    await connection.open("127.0.0.1", int(server.sockets[0].getsockname()[1]))
    writer = await accepted
    try:
        yield connection, Far(writer), lost
    finally:
        connection.close()
        writer.close()
        server.close()


async def test_replies_come_in_the_order_of_the_calls() -> None:
    async with line() as (connection, far, _):
        first = connection.send(MOVING)[0]
        both = connection.send(STOP, MOVING)
        far.say(YES + FOUR + NO)
        assert await first is True
        assert [await one for one in both] == [4, False]


async def test_a_caller_that_gave_up_does_not_disturb_the_next_one() -> None:
    async with line() as (connection, far, lost):
        first = asyncio.create_task(connection.exchange(MOVING, timeout_s=1.0))
        await asyncio.sleep(0)
        first.cancel()
        second = connection.send(MOVING)[0]
        far.say(NO + YES)
        assert await second is True
        assert lost == []


async def test_an_unknown_method_fails_alone() -> None:
    async with line() as (connection, far, lost):
        unknown, known = connection.send(STOP, MOVING)
        far.say(write_unknown("stop") + YES)
        with pytest.raises(MethodUnknown):
            await unknown
        assert await known is True
        assert lost == []


@pytest.mark.parametrize("said", [YES, FOUR[:-1] + b"\7\0\1", b"HTTP/1.1 400"], ids=str)
async def test_what_does_not_fit_ends_the_connection(said: bytes) -> None:
    async with line() as (connection, far, lost):
        replies = connection.send(STOP, MOVING)
        far.say(said)
        for one in replies:
            with pytest.raises(ProtocolViolation):
                await one
        assert isinstance(lost[0], ProtocolViolation)
        with pytest.raises(LinkLost):
            await connection.exchange(MOVING, timeout_s=1.0)


async def test_a_reply_that_nobody_asked_for() -> None:
    async with line() as (connection, far, lost):
        far.say(YES)
        async with asyncio.timeout(1.0):
            while not lost:  # noqa: ASYNC110 - a list tells nobody
                await asyncio.sleep(0.001)
        assert "nobody asked" in lost[0].detail
        assert str(connection) == "arm"


async def test_silence_ends_the_connection() -> None:
    async with line() as (connection, _, lost):
        with pytest.raises(ReplyTimeout, match="robotmoving, stop"):
            await connection.exchange(MOVING, STOP, timeout_s=0.02)
        assert [type(one) for one in lost] == [ReplyTimeout]


async def test_the_far_end_hangs_up() -> None:
    async with line() as (connection, far, lost):
        reply = connection.send(MOVING)[0]
        far.hang_up()
        with pytest.raises(LinkLost):
            await reply
        assert len(lost) == 1


async def test_closing_is_no_loss() -> None:
    async with line() as (connection, _, lost):
        reply = connection.send(MOVING)[0]
        connection.close()
        connection.close()
        with pytest.raises(LinkLost):
            await reply
        assert lost == []


async def test_the_late_end_of_an_old_connection_does_not_touch_the_new_session() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        link = rig.robot._link
        before = link.motion, link.control, link._frames
        rig.reset()
        async with asyncio.timeout(3.0):
            while link.up:  # noqa: ASYNC110 - the loss has no event
                await asyncio.sleep(0.005)
            while not link.up or link._reopening is not None:  # noqa: ASYNC110 - likewise
                await asyncio.sleep(0.005)
        for old, new in zip(before, (link.motion, link.control, link._frames), strict=True):
            assert old is not new
            old.connection_lost(None)
            old.data_received(b"late")
        assert link.up
        assert not rig.robot.state().moving
