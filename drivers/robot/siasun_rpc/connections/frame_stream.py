"""The connection to the state stream. Nothing is ever sent on it."""

import asyncio
from collections.abc import Callable

from cellctl.clock import now_s
from cellctl.errors.link import LinkError, ProtocolViolation
from drivers.robot.siasun_rpc import faults
from drivers.robot.siasun_rpc.codec.state_frame import FrameReader, StateFrame


class FrameStream(asyncio.Protocol):
    """Keeps the newest frame and its time of receipt. ``on_lost`` hears of every end but
    ``close``."""

    def __init__(self, label: str, on_lost: Callable[[LinkError], None]) -> None:
        self.newest: StateFrame | None = None
        self.time_s = 0.0
        """Monotonic time of receipt; of the connection's beginning before the first frame."""
        self._label = label
        self._on_lost = on_lost
        self._reader = FrameReader()
        self._transport: asyncio.BaseTransport | None = None

    async def open(self, host: str, port: int) -> None:
        """Connect; ``ConnectTimeout`` when nobody is there. The caller limits the time."""
        # A frame of the connection before says nothing about a controller that was restarted.
        self.newest, self.time_s, self._reader = None, now_s(), FrameReader()
        try:
            await asyncio.get_running_loop().create_connection(lambda: self, host, port)
        except OSError as error:
            raise faults.cannot_connect(f"{self._label} {host}:{port}", error) from error

    def close(self) -> None:
        """Drop the connection. Idempotent."""
        transport, self._transport = self._transport, None
        if transport is not None:
            transport.close()

    # -- called by the event loop ---------------------------------------------------------------
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The connection stands."""
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Frames, or parts of them."""
        if self._transport is None:
            return
        self._reader.feed(data)
        try:
            while (frame := self._reader.next()) is not None:
                self.newest, self.time_s = frame, now_s()
        except ProtocolViolation as fault:
            self._drop(ProtocolViolation(f"{self._label}: {fault.detail}"))

    def connection_lost(self, exc: Exception | None) -> None:
        """The far end has closed, or the network has given up."""
        self._drop(faults.broken(self._label, exc))

    def _drop(self, fault: LinkError) -> None:
        if self._transport is not None:
            self.close()
            self._on_lost(fault)
