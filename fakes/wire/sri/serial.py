"""The fake box on RS232: the same bytes as over TCP, as many as the baud rate carries."""

import asyncio

from fakes.wire.sri.core import SriCore
from fakes.wire.sri.links import Clock, Link, OnWrite, Pacer, cancel
from fakes.wire.sri.pty import PtyPort
from fakes.wire.sri.session import SriSession

_BITS_PER_BYTE = 10
"""Eight bits of data, a start bit and a stop bit."""


class SerialLink(Link):
    """One session for as long as the line exists."""

    def __init__(self, core: SriCore, clock: Clock, on_write: OnWrite | None, baud: int) -> None:
        self._clock = clock
        self._session = SriSession(core, baud / _BITS_PER_BYTE)
        self._port = PtyPort(self._receive)
        self._pacer = Pacer(self._session, clock, self._port.write, on_write)
        self._session.connected(clock())
        self._sender = asyncio.create_task(self._pacer.run())

    @property
    def path(self) -> str:
        """Device file for the client."""
        return self._port.path

    async def stop(self) -> None:
        """Hang up."""
        await cancel(self._sender)
        self._port.close()

    def _receive(self, data: bytes) -> None:
        if replies := self._session.receive(data, self._clock()):
            self._port.write(replies)
        self._pacer.wake()
