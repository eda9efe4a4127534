"""The page's connection to a daemon that says what the page does not understand."""

import asyncio
import contextlib
import json
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from cellctl.api.local_socket.messages import ANSWER_LIMIT, OnBehalf, PageCommand, PlainCommand
from cellctl.hmi.daemon_link import AnswerMissing, DaemonLink
from cellctl.hmi.hub import Hub
from tests.unit.hmi.scripted_daemon import snapshot

GOOD = json.dumps({**snapshot(), "mono_s": 0.0}).encode()
COMMAND = PageCommand(
    command=PlainCommand(request="reset"),
    on_behalf=OnBehalf(person="anna", role="operate", panel="", key="key-0001"),
)
STRANGE = [
    b'{"kind": "snapshot"}',
    b'{"kind": "snapshot", "mono_s": null, "forces": []}',
    b'{"kind": "snapshot", "mono_s": 1.0, "forces": [null]}',
    b'{"kind": "snapshot", "mono_s": 1.0, "forces": 7}',
    b"[]",
    b"x" * (ANSWER_LIMIT + 1),
]


def served(
    path: Path, lines: list[bytes], then: Callable[[DaemonLink, Hub], Awaitable[None]]
) -> None:
    """Each connection is sent the next of these lines, and the last one again and again."""

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write((lines.pop(0) if len(lines) > 1 else lines[0]) + b"\n")
        with contextlib.suppress(ConnectionError):
            await reader.read()  # until the other one has left
        writer.transport.abort()

    async def serve() -> None:
        async with await asyncio.start_unix_server(answer, str(path)):
            hub = Hub()
            await then(DaemonLink(path, hub), hub)
            await asyncio.sleep(0.05)

    asyncio.run(serve())


@pytest.mark.parametrize("strange", STRANGE, ids=range(len(STRANGE)))
def test_after_a_line_it_does_not_understand_it_connects_anew(
    tmp_path: Path, strange: bytes
) -> None:
    """Nobody starts a follower that has ended: the page would show the old state for ever."""

    async def follow(link: DaemonLink, hub: Hub) -> None:
        following = asyncio.create_task(link.follow())
        while not hub.linked and not following.done():
            await hub.wait(hub.version, 0.1)
        assert hub.linked
        assert hub.age_s is not None
        following.cancel()
        await asyncio.wait([following])

    served(tmp_path / "s", [strange, GOOD], follow)


@pytest.mark.parametrize("strange", [STRANGE[0], STRANGE[-1]], ids=["unknown", "endless"])
def test_an_answer_it_does_not_understand_leaves_open_what_became_of_it(
    tmp_path: Path, strange: bytes
) -> None:
    async def ask(link: DaemonLink, _hub: Hub) -> None:
        with pytest.raises(AnswerMissing):
            await link.ask(COMMAND)

    served(tmp_path / "s", [strange], ask)


def test_an_answer_that_does_not_come_is_waited_for_no_longer_than_said(tmp_path: Path) -> None:
    async def keep_silent(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError):
            await reader.read()  # until the other one has left
        writer.transport.abort()

    async def ask() -> None:
        async with await asyncio.start_unix_server(keep_silent, str(tmp_path / "s")):
            link = DaemonLink(tmp_path / "s", Hub(), answer_s=0.2)
            async with asyncio.timeout(5.0):
                with pytest.raises(AnswerMissing):
                    await link.ask(COMMAND)
            await asyncio.sleep(0.05)

    asyncio.run(ask())
