"""The TCP connection to a target server: one request at a time, each with a time limit."""

import asyncio
import logging
from collections.abc import Callable
from typing import TypeVar

from cellctl.errors.link import LinkLost, ProtocolViolation
from drivers.camera.target_server import faults, protocol
from drivers.camera.target_server.config import TargetServerConfig

_log = logging.getLogger(__name__)
Value = TypeVar("Value")


class TargetServerConnection:
    """Closes itself whenever an exchange does not end as it should, because the next line would
    belong to nobody. ``open`` again after that.
    """

    def __init__(self, config: TargetServerConfig) -> None:
        self._config = config
        self._peer = f"target server {config.host}:{config.port}"
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
                        self._config.host, self._config.port, limit=protocol.MAX_LINE_BYTES
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

    async def exchange(
        self,
        build: Callable[[int], bytes],
        parse: Callable[[bytes, int], Value],
        timeout_s: float,
    ) -> Value:
        """Send ``build(id)`` and return ``parse(reply, id)``."""
        async with self._lock:
            try:
                async with asyncio.timeout(timeout_s):
                    line = await self._exchange(build)
                return parse(line, self._request_id)
            except TimeoutError:
                await self.close()
                raise faults.silent(self._peer, timeout_s) from None
            except (OSError, EOFError) as error:
                await self.close()
                raise faults.broken(self._peer, error) from error
            except asyncio.LimitOverrunError as error:
                await self.close()
                raise ProtocolViolation(f"{self._peer}: line too long") from error
            except (ProtocolViolation, asyncio.CancelledError):
                await self.close()
                raise

    async def _exchange(self, build: Callable[[int], bytes]) -> bytes:
        if self._streams is None:
            raise LinkLost(f"{self._peer} is not connected")
        reader, writer = self._streams
        self._request_id += 1
        request = build(self._request_id)
        _log.debug("%s -> %r", self._peer, request)
        writer.write(request)
        line = await reader.readuntil(b"\n")
        _log.debug("%s <- %r", self._peer, line)
        return line
