"""The control port of the fake cell: the hands of an operator and the eyes of a measuring room.

Lines of JSON, ``{"id": 1, "cmd": "truth"}`` answered by ``{"id": 1, "status": "ok", …}`` or
``{"id": 1, "status": "error", "message": "…"}``. For demonstrations and tests only; the daemon
never speaks to it.
"""

import asyncio
import json
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Any

Handler = Callable[..., Awaitable[dict[str, Any]]]


class ControlServer:
    """Any number of clients; a handler gets the other members of the request as keywords."""

    def __init__(self, handlers: dict[str, Handler]) -> None:
        self._handlers = handlers
        self._server: asyncio.Server | None = None
        self._writers: set[asyncio.StreamWriter] = set()

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen; returns the port."""
        self._server = await asyncio.start_server(self._serve, host, port)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Stop listening and hang up. Idempotent."""
        server, self._server = self._server, None
        for writer in self._writers:
            writer.close()
        if server is not None:
            server.close()
            await server.wait_closed()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.add(writer)
        try:
            while line := await reader.readline():
                writer.write(json.dumps(await self._answer(line)).encode() + b"\n")
                await writer.drain()
        except (ConnectionError, ValueError):
            pass  # the client has gone, or sent a line without an end: hang up
        finally:
            self._writers.discard(writer)
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def _answer(self, line: bytes) -> dict[str, Any]:
        number: Any = None
        try:
            request = json.loads(line)
            number = request.pop("id")
            handler = self._handler(request.pop("cmd"))
            return {"id": number, "status": "ok", **await handler(**request)}
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            return {"id": number, "status": "error", "message": str(error)}

    def _handler(self, name: str) -> Handler:
        if name not in self._handlers:
            raise ValueError(f"unknown command {name!r}; known: {sorted(self._handlers)}")
        return self._handlers[name]
