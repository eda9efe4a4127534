"""The connections of the local API, their lines and limits; knows nothing of the cell."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import dataclass
from typing import Any

from cellctl import log
from cellctl.api.local_socket.messages import (
    REQUEST_LIMIT,
    Answer,
    Failed,
    FollowRequest,
    Request,
    parse_request,
    to_line,
)
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.api.local_socket.users import peer_uid
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.errors.local import MessageMalformed

Handle = Callable[[Request, int], Coroutine[Any, Any, Answer]]
"""Answers a request; the second argument is the number of the user who asks."""

Follow = Callable[[asyncio.StreamWriter], Awaitable[None]]
"""Pushes the live view to a connection until that ends."""

_log = log.get(__name__)


@dataclass(frozen=True, slots=True)
class LocalLimits:
    """How many connections are served, and how long each may take."""

    clients: int = 16
    """Connections at a time: the page has a few, each terminal one."""
    idle_s: float = 30.0
    """A client that says nothing for this time was forgotten: a terminal asks and hangs up."""
    request_s: float = 3.0
    """Time from the first byte of a request to its last, and for an answer to be taken."""


class LocalServer:
    """Answers the requests of each connection one by one."""

    def __init__(
        self,
        file: SocketFile,
        handle: Handle,
        follow: Follow,
        limits: LocalLimits | None = None,
    ) -> None:
        self._file = file
        self._handle = handle
        self._follow = follow
        self._limits = limits or LocalLimits()
        self._server: asyncio.Server | None = None
        self._clients: dict[asyncio.Task[None], None] = {}
        self._handling: set[asyncio.Task[Answer]] = set()
        self._followers: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Listen; raises ``LocalApiInUse`` or ``CannotServeLocally``."""
        listener = self._file.open()
        self._server = await asyncio.start_unix_server(
            self._connected, sock=listener, limit=REQUEST_LIMIT
        )
        _log.info("local API", socket=str(self._file.path))

    async def stop(self) -> None:
        """Stop listening, drop all clients, and wait for commands that were begun. Idempotent."""
        if self._server is not None:
            # No ``wait_closed``: it would wait for the clients, which are ended below.
            self._server.close()
            self._server = None
            self._file.remove()
        # Commands that were begun are awaited, not cancelled: an Abort that has been accepted is
        # carried out.
        clients = (*self._clients, *self._followers)
        for client in clients:
            client.cancel()
        await asyncio.gather(*clients, *self._handling, return_exceptions=True)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        if len(self._clients) >= self._limits.clients:
            # The oldest has to go: an Abort must always get in. It is taken out at once, because
            # its own clean-up runs later and the next newcomer must not choose it again.
            oldest = next(iter(self._clients))
            del self._clients[oldest]
            oldest.cancel()
        self._clients[task] = None
        writer.transport.set_write_buffer_limits(0)  # drain waits until everything is handed over
        try:
            await self._serve(reader, writer, peer_uid(writer.get_extra_info("socket")))
        # The cancellation ends here on purpose: it comes from ``stop`` or from a newer client, and
        # concerns this connection alone.
        except (TimeoutError, OSError, asyncio.CancelledError) as error:
            _log.info("local client dropped", reason=type(error).__name__)
        finally:
            self._clients.pop(task, None)
            self._followers.discard(task)
            writer.transport.abort()

    async def _serve(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, uid: int
    ) -> None:
        goes_on = True
        while goes_on:
            try:
                line = await self._line(reader)
                request = _parsed(line, uid)
                if isinstance(request, FollowRequest):
                    await self._push(writer)
                    return
                answer = await self._answer(request, uid)
            except EOFError:
                return
            except asyncio.LimitOverrunError:
                fault = MessageMalformed(f"longer than {REQUEST_LIMIT} bytes")
                answer = Failed(number=fault.number, text=str(fault))
                goes_on = False  # where the next request begins cannot be told
            writer.write(to_line(answer))
            async with asyncio.timeout(self._limits.request_s):
                await writer.drain()

    async def _line(self, reader: asyncio.StreamReader) -> bytes:
        """A line; raises ``EOFError``, ``TimeoutError`` or ``LimitOverrunError``."""
        async with asyncio.timeout(self._limits.idle_s):
            first = await reader.readexactly(1)
        # An empty line; waiting for the end of another one would make its sender wait for its
        # answer.
        if first == b"\n":
            return b""
        async with asyncio.timeout(self._limits.request_s):
            return first + await reader.readuntil()

    async def _push(self, writer: asyncio.StreamWriter) -> None:
        """Push until the connection ends. A follower is no client: newer ones do not drop it."""
        task = asyncio.current_task()
        assert task is not None
        self._clients.pop(task, None)
        self._followers.add(task)
        await self._follow(writer)

    async def _answer(self, request: Request | Failed, uid: int) -> Answer:
        """The answer to a request. A command that was begun ends even when its client is gone."""
        if isinstance(request, Failed):
            return request
        task = asyncio.create_task(self._handle(request, uid))
        self._handling.add(task)
        task.add_done_callback(self._handling.discard)
        # ``wait`` leaves the task alone when this connection is cancelled: whoever gives a command
        # and hangs up has given it all the same.
        await asyncio.wait({task})
        error = task.exception()
        if error is None:
            return task.result()
        _log.error("local request failed", uid=uid, fault=str(error), exc_info=error)
        unknown = f"{type(error).__name__} in the local API: {error}"
        known = error if isinstance(error, CellError) else Unexpected(unknown)
        return Failed(number=known.number, text=str(known))


def _parsed(line: bytes, uid: int) -> Request | Failed:
    try:
        return parse_request(line)
    except MessageMalformed as fault:
        _log.warning("local request malformed", uid=uid, fault=str(fault))
        return Failed(number=fault.number, text=str(fault))
