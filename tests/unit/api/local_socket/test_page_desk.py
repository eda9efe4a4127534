"""A command that comes again and again, over connections that are cut, is obeyed once."""

import asyncio
import random
from collections import Counter
from pathlib import Path

from cellctl.api.local_socket.messages import (
    Answer,
    CommandRequest,
    OnBehalf,
    PageCommand,
    PlainCommand,
    Request,
    Taken,
    to_line,
)
from cellctl.api.local_socket.page_desk import PageDesk
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.api.local_socket.users import Users
from cellctl.hmi.daemon_link import DaemonLink
from cellctl.hmi.hub import Hub

KEYS, REPEATS, AT_ONCE = 100, 10, 8


def wanted(key: int) -> PageCommand:
    person = OnBehalf(person="anna", role="operate", panel="p", decision=0, key=f"key-{key:05}")
    return PageCommand(on_behalf=person, command=PlainCommand(request="reset"))


async def cut(path: Path, command: PageCommand) -> None:
    """Send it, and hang up without waiting for the answer."""
    _, writer = await asyncio.open_unix_connection(str(path))
    writer.write(to_line(command))
    await writer.drain()
    writer.transport.abort()


async def test_a_thousand_repeats_over_cut_connections_obey_nothing_twice(tmp_path: Path) -> None:
    obeyed: Counter[str] = Counter()
    answers: dict[str, set[str]] = {}

    async def obey(_command: CommandRequest, _who: str, details: object) -> Taken:
        assert isinstance(details, dict)
        obeyed[details["key"]] += 1
        await asyncio.sleep(0)  # others come meanwhile
        return Taken(state=f"{details['key']} {obeyed[details['key']]}")

    desk = PageDesk("", Users(), lambda: 0, obey, lambda *_: None)

    async def handle(request: Request, uid: int) -> Answer:
        assert isinstance(request, PageCommand)
        return await desk.handle(request, uid)

    async def follow(_writer: asyncio.StreamWriter) -> None:
        raise AssertionError("nobody follows")

    path = tmp_path / "s"
    server = LocalServer(SocketFile(path, ""), handle, follow)
    await server.start()
    link = DaemonLink(path, Hub())
    few = asyncio.Semaphore(AT_ONCE)

    async def send(key: int, *, whole: bool) -> None:
        async with few:
            if not whole:
                await cut(path, wanted(key))
                return
            answer = await link.ask(wanted(key))
        assert isinstance(answer, Taken)
        answers.setdefault(f"key-{key:05}", set()).add(answer.state)

    # The last of each key waits for its answer; of the others every second one does.
    sends = [(key, repeat % 2 == 0) for key in range(KEYS) for repeat in range(REPEATS - 1)]
    random.Random(1).shuffle(sends)
    await asyncio.gather(*(send(key, whole=whole) for key, whole in sends))
    await asyncio.gather(*(send(key, whole=True) for key in range(KEYS)))
    await server.stop()
    assert set(obeyed.values()) == {1}
    assert len(obeyed) == KEYS
    assert {len(states) for states in answers.values()} == {1}, "the same answer each time"
