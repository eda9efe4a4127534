"""A TCP proxy that mistreats the bytes between two ends.

async with ChaosProxy(target_port) as proxy:
    client.connect(proxy.port)
    proxy.forth.corrupt_in = 40      # flip a bit in the 40th byte from the client
    proxy.back.blocked = True        # half open: nothing comes back any more, nothing ends
    proxy.reset()                    # RST to both ends
"""

import asyncio
import socket
import struct
from dataclasses import dataclass
from types import TracebackType
from typing import Self


@dataclass(slots=True)
class Chaos:
    """What happens to one direction; may be changed while connections stand."""

    split: bool = False
    """Every byte in a packet of its own."""
    merge_bytes: int = 0
    """Hold bytes back until there are so many."""
    delay_s: float = 0.0
    corrupt_in: int | None = None
    """Flip the lowest bit of the byte that many bytes from now."""
    repeat_next: int = 1
    """The next piece goes on so many times."""
    drop_bytes: int = 0
    """Swallow the next so many bytes."""
    blocked: bool = False
    """Swallow everything, the end of the stream included."""

    def apply(self, data: bytes) -> bytes:
        """What is left of a piece of the stream."""
        if self.blocked:
            return b""
        dropped = min(self.drop_bytes, len(data))
        self.drop_bytes -= dropped
        data = data[dropped:] * self.repeat_next
        self.repeat_next = 1
        if self.corrupt_in is None:
            return data
        if self.corrupt_in >= len(data):
            self.corrupt_in -= len(data)
            return data
        at, self.corrupt_in = self.corrupt_in, None
        return data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :]


class ChaosProxy:
    """Forwards every connection on ``port`` to ``target_port`` of this PC."""

    def __init__(self, target_port: int, port: int = 0) -> None:
        self.port = port
        self.forth = Chaos()
        """Chaos for what comes from the end that connects."""
        self.back = Chaos()
        self._target_port = target_port
        self._server: asyncio.Server | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._writers: set[asyncio.StreamWriter] = set()

    async def __aenter__(self) -> Self:
        self._server = await asyncio.start_server(self._accept, "127.0.0.1", self.port)
        self.port = int(self._server.sockets[0].getsockname()[1])
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        assert self._server is not None
        self._server.close()
        for writer in self._writers:
            writer.transport.abort()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    @property
    def connections(self) -> int:
        """How many stand now."""
        return len(self._writers) // 2

    def reset(self) -> None:
        """RST on both ends of every connection."""
        for writer in self._writers:
            linger = struct.pack("ii", 1, 0)
            sock = writer.get_extra_info("socket")
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
            writer.transport.abort()

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.create_task(self._serve(reader, writer))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        # A task that is cancelled before its first turn closes nothing.
        task.add_done_callback(lambda _: writer.transport.abort())

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            far_reader, far_writer = await asyncio.open_connection("127.0.0.1", self._target_port)
        # Refused or reset by a peer that has just closed, or given up at the end of a test: nobody
        # else knows this end.
        except (OSError, asyncio.CancelledError):
            writer.transport.abort()
            await asyncio.gather(writer.wait_closed(), return_exceptions=True)
            return
        pair = {writer, far_writer}
        self._writers |= pair
        for end in pair:
            end.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        pumps = (
            self._pump(reader, far_writer, self.forth),
            self._pump(far_reader, writer, self.back),
        )
        try:
            await asyncio.gather(*pumps)
        except ConnectionError:
            self._writers -= pair
        finally:
            self._writers -= pair
            for end in pair:
                end.transport.abort()
            await asyncio.gather(*(end.wait_closed() for end in pair), return_exceptions=True)

    async def _pump(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, chaos: Chaos
    ) -> None:
        held = b""
        while data := await reader.read(4096):
            held += chaos.apply(data)
            if not held or len(held) < chaos.merge_bytes:
                continue
            if chaos.delay_s:
                await asyncio.sleep(chaos.delay_s)
            pieces = [held[k : k + 1] for k in range(len(held))] if chaos.split else [held]
            held = b""
            for piece in pieces:
                writer.write(piece)
                await writer.drain()
        if not chaos.blocked:
            writer.write_eof()
            raise ConnectionError("one end has closed")
