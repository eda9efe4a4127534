"""The TCP connection to a frame server: one request at a time, each with a time limit."""

import asyncio
import logging

from cellctl.errors.link import LinkLost, ProtocolViolation
from drivers.camera.frame_server import faults, protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.protocol import Command, Header, Status

_log = logging.getLogger(__name__)


class FrameServerConnection:
    """Closes itself whenever an exchange does not end as it should, because the next bytes would
    belong to nobody. ``open`` again after that.
    """

    def __init__(self, config: FrameServerConfig) -> None:
        self._config = config
        self._peer = f"frame server {config.host}:{config.port}"
        self._lock = asyncio.Lock()
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
        self._request_id = 0

    @property
    def connected(self) -> bool:
        """A connection stands."""
        return self._streams is not None

    async def open(self) -> None:
        """Connect; ``ConnectTimeout`` when nobody answers. Idempotent."""
        async with self._lock:
            if self._streams is not None:
                return
            try:
                async with asyncio.timeout(self._config.connect_timeout_s):
                    self._streams = await asyncio.open_connection(
                        self._config.host, self._config.port
                    )
            except OSError as error:
                raise faults.cannot_connect(self._peer, error) from error
            _log.info("%s: connected", self._peer)

    async def close(self) -> None:
        """Drop the connection. Idempotent."""
        streams, self._streams = self._streams, None
        if streams is not None:
            streams[1].transport.abort()
            await asyncio.gather(streams[1].wait_closed(), return_exceptions=True)

    async def exchange(self, command: Command) -> tuple[Header, bytes]:
        """Send a request and return its checked reply."""
        async with self._lock:
            try:
                async with asyncio.timeout(self._config.reply_timeout_s):
                    header, payload = await self._exchange(command)
            except TimeoutError:
                await self.close()
                raise faults.silent(self._peer, self._config.reply_timeout_s) from None
            except (OSError, EOFError) as error:
                await self.close()
                raise faults.broken(self._peer, error) from error
            except (ProtocolViolation, asyncio.CancelledError):
                await self.close()
                raise
        if header.status is not Status.OK:
            raise faults.refused(self._peer, header.status)
        return header, payload

    async def _exchange(self, command: Command) -> tuple[Header, bytes]:
        if self._streams is None:
            raise LinkLost(f"{self._peer} is not connected")
        reader, writer = self._streams
        self._request_id = self._request_id % 0xFFFF_FFFF + 1
        writer.write(protocol.request(command, self._request_id))
        _log.debug("%s -> %s %d", self._peer, command.name, self._request_id)
        data = await reader.readexactly(protocol.HEADER_BYTES)
        header = protocol.parse_header(data, command, self._request_id)
        _log.debug("%s <- %s", self._peer, header)
        payload = await reader.readexactly(header.payload_bytes)
        protocol.check_payload(header, payload)
        return header, payload
