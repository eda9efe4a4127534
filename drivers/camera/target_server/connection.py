"""Requests to a target server and their replies, a line each."""

import asyncio
import logging
from collections.abc import Callable
from typing import TypeVar

from drivers.camera.link import RequestLink
from drivers.camera.target_server import protocol
from drivers.camera.target_server.config import TargetServerConfig

_log = logging.getLogger(__name__)
Value = TypeVar("Value")


class TargetServerConnection:
    """The link to one head; see ``RequestLink`` for how it ends."""

    def __init__(self, name: str, config: TargetServerConfig) -> None:
        self.link = RequestLink(
            f"{name}, target server",
            config.host,
            config.port,
            config.connect_timeout_s,
            protocol.MAX_LINE_BYTES,
        )
        self._request_id = 0

    async def exchange(
        self,
        build: Callable[[int], bytes],
        parse: Callable[[bytes, int], Value],
        timeout_s: float,
    ) -> Value:
        """Send ``build(id)`` and return ``parse(reply, id)``."""
        self._request_id += 1
        number = self._request_id

        async def talk(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> Value:
            request = build(number)
            _log.debug("%s -> %r", self.link.peer, request)
            writer.write(request)
            # The limit of the stream ends a line that has no end; otherwise a wrong server could
            # fill the memory.
            line = await reader.readuntil(b"\n")
            _log.debug("%s <- %r", self.link.peer, line)
            return parse(line, number)

        return await self.link.exchange(talk, timeout_s)
