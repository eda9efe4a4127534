"""The wire: lines, limits, and clients that misbehave."""

import asyncio
import json
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from cellctl.api.local_socket.messages import Answer, Request, Taken
from cellctl.api.local_socket.server import LocalLimits, LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.errors.link import LinkLost

WAIT_S = 5.0


async def nobody_follows(_writer: asyncio.StreamWriter) -> None:
    raise AssertionError("nobody has asked to follow")


QUICK = LocalLimits(clients=3, idle_s=0.3, request_s=0.2)
ABORT = b'{"request": "abort"}\n'


class Desk:
    """Takes everything; a test may keep it from answering."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, int]] = []
        self.done: list[str] = []
        self.may_end = asyncio.Event()
        self.may_end.set()
        self.fault: Exception | None = None

    async def __call__(self, request: Request, uid: int) -> Answer:
        self.asked.append((request.request, uid))
        await self.may_end.wait()
        if self.fault is not None:
            raise self.fault
        self.done.append(request.request)
        return Taken(state="ABORTING")


@pytest.fixture
def desk() -> Desk:
    return Desk()


@pytest.fixture
async def server(desk: Desk, tmp_path: Path) -> AsyncIterator[LocalServer]:
    server = LocalServer(SocketFile(tmp_path / "s", ""), desk, nobody_follows, QUICK)
    await server.start()
    yield server
    desk.may_end.set()
    await server.stop()


class Client:
    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def ask(self, line: bytes) -> dict[str, Any]:
        self.writer.write(line)
        answer: dict[str, Any] = json.loads(await self.line())
        return answer

    async def line(self) -> bytes:
        return await asyncio.wait_for(self.reader.readline(), WAIT_S)


@asynccontextmanager
async def connected(tmp_path: Path) -> AsyncIterator[Client]:
    reader, writer = await asyncio.open_unix_connection(tmp_path / "s")
    try:
        yield Client(reader, writer)
    finally:
        writer.transport.abort()


async def test_a_request_is_answered_and_its_user_known(
    server: LocalServer, desk: Desk, tmp_path: Path
) -> None:
    async with connected(tmp_path) as client:
        assert await client.ask(ABORT) == {"answer": "taken", "state": "ABORTING"}
        assert await client.ask(ABORT) == {"answer": "taken", "state": "ABORTING"}
    assert desk.asked == [("abort", os.getuid())] * 2


@pytest.mark.parametrize("line", [b"\n", b"{}\n", b"\xff\xfe\n", b'{"request":"abort","x":1}\n'])
async def test_malformed_lines_touch_nothing_and_the_next_one_counts(
    server: LocalServer, desk: Desk, tmp_path: Path, line: bytes
) -> None:
    async with connected(tmp_path) as client:
        answer = await client.ask(line)
        assert (answer["answer"], answer["number"]) == ("failed", 713)
        assert desk.asked == []
        assert (await client.ask(ABORT))["answer"] == "taken"


async def test_a_line_beyond_the_limit_ends_the_connection(
    server: LocalServer, desk: Desk, tmp_path: Path
) -> None:
    async with connected(tmp_path) as client:
        answer = await client.ask(b" " * 9000 + ABORT)
        assert answer["number"] == 713
        assert await client.line() == b""
    assert desk.asked == []


@pytest.mark.parametrize("sent", [b"", ABORT[:-1]])
async def test_who_is_silent_or_stops_within_a_line_is_dropped(
    server: LocalServer, desk: Desk, tmp_path: Path, sent: bytes
) -> None:
    async with connected(tmp_path) as client:
        client.writer.write(sent)
        assert await client.line() == b""
    assert desk.asked == []


async def test_half_a_request_before_the_end_is_none(
    server: LocalServer, desk: Desk, tmp_path: Path
) -> None:
    async with connected(tmp_path) as client:
        client.writer.write(ABORT[:-1])
        client.writer.write_eof()
        assert await client.line() == b""
    assert desk.asked == []


async def test_an_abort_gets_in_however_many_clients_hang(
    server: LocalServer, tmp_path: Path
) -> None:
    hanging = [await asyncio.open_unix_connection(tmp_path / "s") for _ in range(QUICK.clients + 2)]
    async with connected(tmp_path) as client:
        assert (await client.ask(ABORT))["answer"] == "taken"
    for _, writer in hanging:
        writer.transport.abort()


async def test_an_abort_waits_for_no_other_client(
    server: LocalServer, desk: Desk, tmp_path: Path
) -> None:
    async with connected(tmp_path) as first, connected(tmp_path) as second:
        desk.may_end.clear()
        first.writer.write(b'{"request": "reset"}\n')
        second.writer.write(ABORT)
        async with asyncio.timeout(WAIT_S):
            while len(desk.asked) < 2:  # noqa: ASYNC110 - the server's own turn
                await asyncio.sleep(0.01)


async def test_what_was_begun_is_carried_out_though_who_asked_has_gone(
    server: LocalServer, desk: Desk, tmp_path: Path
) -> None:
    desk.may_end.clear()
    async with connected(tmp_path) as client:
        client.writer.write(ABORT)
        async with asyncio.timeout(WAIT_S):
            while not desk.asked:  # noqa: ASYNC110 - the server's own turn
                await asyncio.sleep(0.01)
    desk.may_end.set()
    await server.stop()
    assert desk.done == ["abort"]


@pytest.mark.parametrize(("fault", "number"), [(LinkLost("main"), 202), (KeyError("x"), 901)])
async def test_a_fault_is_an_answer(
    server: LocalServer, desk: Desk, tmp_path: Path, fault: Exception, number: int
) -> None:
    desk.fault = fault
    async with connected(tmp_path) as client:
        answer = await client.ask(ABORT)
        assert (answer["answer"], answer["number"]) == ("failed", number)
        assert (await client.ask(ABORT))["number"] == number, "the server goes on"


async def test_nothing_is_left_of_it(server: LocalServer, tmp_path: Path) -> None:
    async with connected(tmp_path) as client:
        assert await client.ask(ABORT)
        await server.stop()
        assert await client.line() == b""
    assert not (tmp_path / "s").exists()
    await server.stop()


async def test_clients_that_come_all_at_once_keep_to_the_limit(
    server: LocalServer, tmp_path: Path
) -> None:
    opened = [asyncio.open_unix_connection(tmp_path / "s") for _ in range(4 * QUICK.clients)]
    streams = await asyncio.gather(*opened)
    for _ in range(20):
        await asyncio.sleep(0.005)
    assert len(server._clients) == QUICK.clients
    for _, writer in streams:
        writer.transport.abort()
