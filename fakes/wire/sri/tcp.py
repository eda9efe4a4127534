"""The fake box as a TCP server: commands and frames on one plain byte stream."""

import asyncio
import socket

from fakes.wire.sri.core import SriCore
from fakes.wire.sri.links import Clock, Link, OnWrite, Pacer, cancel
from fakes.wire.sri.session import SriSession

_FULL_BYTES = 256 * 1024
"""Frames that a client leaves unread beyond this are lost, as in a box with a full buffer."""


class TcpLink(Link):
    """Every client gets its own session on the same core."""

    def __init__(self, core: SriCore, clock: Clock, on_write: OnWrite | None) -> None:
        self._core = core
        self._clock = clock
        self._on_write = on_write
        self._server: asyncio.Server | None = None
        self._clients: set[asyncio.Task[None]] = set()

    async def start(self, host: str, port: int) -> int:
        """Listen; returns the port."""
        self._server = await asyncio.start_server(self._accept, host, port)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Close the listener and every client."""
        if self._server is None:
            return
        self._server.close()
        for task in list(self._clients):
            await cancel(task)
        await self._server.wait_closed()
        self._server = None

    def drop_clients(self) -> None:
        """Close every connection at once, as a cable or a power cut does."""
        for task in self._clients:
            task.cancel()

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.get_running_loop().create_task(self._serve(reader, writer))
        self._clients.add(task)
        task.add_done_callback(self._clients.discard)
        # A task that is cancelled before its first turn closes nothing.
        task.add_done_callback(lambda _: writer.transport.abort())

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        sock = writer.get_extra_info("socket")
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

        def write(data: bytes) -> bool:
            if writer.transport.get_write_buffer_size() > _FULL_BYTES:
                return False
            writer.write(data)
            return True

        session = SriSession(self._core)
        pacer = Pacer(session, self._clock, write, self._on_write)
        session.connected(self._clock())
        sender = asyncio.create_task(pacer.run())
        try:
            while data := await reader.read(4096):
                if replies := session.receive(data, self._clock()):
                    writer.write(replies)
                pacer.wake()
        except ConnectionError:
            writer.transport.abort()
        finally:
            writer.transport.abort()
            await cancel(sender)
            await asyncio.gather(writer.wait_closed(), return_exceptions=True)
