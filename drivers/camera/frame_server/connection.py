"""Requests to a frame server, their checked replies, and the state of the link between them."""

import asyncio
import logging
from dataclasses import dataclass

from cellctl.clock import now_s
from cellctl.errors.link import ProtocolViolation
from drivers.camera.frame_server import faults, protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.protocol import Header, ServerCommand, ServerStatus
from drivers.camera.link import RequestLink

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Exposure:
    """A reply to a grab that has passed every check."""

    header: Header
    payload: bytes
    time_s: float
    """Monotonic time of its last byte."""


class FrameServerConnection:
    """The link to one server; see ``RequestLink`` for how it ends.

    Between ``connect`` and ``disconnect`` a lost connection is made again by the next request;
    the request that lost it fails.
    """

    def __init__(self, name: str, config: FrameServerConfig) -> None:
        self.link = RequestLink(
            f"{name}, frame server", config.host, config.port, config.connect_timeout_s
        )
        self._name = name
        self._reply_timeout_s = config.reply_timeout_s
        self._request_id = 0
        self._last: Header | None = None

    async def connect(self) -> None:
        """Connect and see that a server answers."""
        await self.link.take_up(self.serial_number)

    async def disconnect(self) -> None:
        """Drop the connection."""
        await self.link.give_up()

    async def serial_number(self) -> str:
        """Serial number of the camera or head."""
        await self._ready()
        _, payload = await self._exchange(ServerCommand.IDENTIFY)
        _, serial, _ = protocol.parse_identity(payload)
        return serial

    async def expose(self, command: ServerCommand) -> Exposure:
        """Expose now. A frame number or time stamp that does not move on is a violation: the
        server would have sent an old image of a scene that has moved since."""
        await self._ready()
        header, payload = await self._exchange(command)
        time_s = now_s()
        last, self._last = self._last, header
        if last is not None and (
            # Both must move on. A server that repeats its buffer may still count its replies, and
            # one whose camera hangs may still read its clock.
            header.frame_id == last.frame_id or header.exposure_time_us <= last.exposure_time_us
        ):
            await self.link.close()
            raise ProtocolViolation(f"{self._name}: the server sent frame {header.frame_id} again")
        return Exposure(header, payload, time_s)

    async def _ready(self) -> None:
        if await self.link.restore():
            # A server that was started again counts its frames from the beginning.
            self._last = None

    async def _exchange(self, command: ServerCommand) -> tuple[Header, bytes]:
        """Send a request and return its checked reply; ``DeviceFault`` for a refusal."""
        # 32 bits on the wire; zero is left out, so that an empty header never fits.
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
        if header.status is not ServerStatus.OK:
            raise faults.refused(self.link.peer, header.status)
        return header, payload
