"""Requests to a frame server and their checked replies."""

import asyncio
import logging

from drivers.camera.frame_server import faults, protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.protocol import Command, Header, Status
from drivers.camera.link import RequestLink

_log = logging.getLogger(__name__)


class FrameServerConnection:
    """The link to one head; see ``RequestLink`` for how it ends."""

    def __init__(self, name: str, config: FrameServerConfig) -> None:
        self._reply_timeout_s = config.reply_timeout_s
        self.link = RequestLink(
            f"{name}, frame server", config.host, config.port, config.connect_timeout_s
        )
        self._request_id = 0

    async def exchange(self, command: Command) -> tuple[Header, bytes]:
        """Send a request and return its checked reply; ``DeviceFault`` for a refusal."""
        self._request_id = self._request_id % 0xFFFF_FFFF + 1
        number = self._request_id

        async def talk(
            reader: asyncio.StreamReader, writer: asyncio.StreamWriter
        ) -> tuple[Header, bytes]:
            writer.write(protocol.request(command, number))
            _log.debug("%s -> %s %d", self.link.peer, command.name, number)
            data = await reader.readexactly(protocol.HEADER_BYTES)
            header = protocol.parse_header(data, command, number)
            _log.debug("%s <- %s", self.link.peer, header)
            payload = await reader.readexactly(header.payload_bytes)
            protocol.check_payload(header, payload)
            return header, payload

        header, payload = await self.link.exchange(talk, self._reply_timeout_s)
        if header.status is not Status.OK:
            raise faults.refused(self.link.peer, header.status)
        return header, payload
