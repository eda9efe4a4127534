"""A network line between a browser and the page's process that gets slow, or loses its cable."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import AsyncExitStack, contextmanager, suppress
from dataclasses import dataclass, field

PIECE = 1024


@dataclass
class BadLine:
    """Its fields may be changed while it carries."""

    port: int
    """Of the page's process on this PC."""
    rate_b_s: float = 0.0
    """Bytes a second towards the browser, of all connections together; 0 without a limit."""
    cut: bool = False
    """While it lasts nothing is carried, and nobody is told. Connections that were open then stay
    so, and dead, when the cable is back: as when the other end has given up meanwhile."""
    _due_s: float = field(default=0.0, init=False)

    async def carry(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """One connection of the browser, to its end."""
        async with AsyncExitStack() as stack:
            stack.push_async_callback(_closed, writer)
            await self._while_cut()
            away, back = await asyncio.open_connection("127.0.0.1", self.port)
            stack.push_async_callback(_closed, back)
            try:
                async with asyncio.TaskGroup() as tasks:
                    tasks.create_task(self._forward(reader, back, slow=False))
                    tasks.create_task(self._forward(away, writer, slow=True))
            except* OSError:
                pass

    async def _while_cut(self) -> None:
        if self.cut:
            await asyncio.Event().wait()

    async def _forward(
        self, source: asyncio.StreamReader, sink: asyncio.StreamWriter, *, slow: bool
    ) -> None:
        while piece := await source.read(PIECE):
            await self._while_cut()
            if slow and self.rate_b_s:
                now_s = asyncio.get_running_loop().time()
                self._due_s = max(self._due_s, now_s) + len(piece) / self.rate_b_s
                await asyncio.sleep(self._due_s - now_s)
            sink.write(piece)
            await sink.drain()
        raise ConnectionResetError("one end has gone")  # and with it the other


async def _closed(writer: asyncio.StreamWriter) -> None:
    writer.close()
    with suppress(OSError):
        await writer.wait_closed()


@contextmanager
def bad_line(url: str) -> Iterator[tuple[BadLine, str]]:
    """The line to the page at ``url``, and the address of its other end."""
    line = BadLine(int(url.rstrip("/").rsplit(":", 1)[1]))
    loop, ports, down = asyncio.new_event_loop(), list[int](), asyncio.Event()
    up = threading.Event()

    async def serve() -> None:
        # Little is under way in it: a line that holds back a second's worth is no slow one.
        server = await asyncio.start_server(line.carry, "127.0.0.1", 0, limit=PIECE)
        ports.append(server.sockets[0].getsockname()[1])
        up.set()
        await down.wait()
        server.close()
        left = asyncio.all_tasks() - {asyncio.current_task()}
        for task in left:
            task.cancel()
        await asyncio.gather(*left, return_exceptions=True)

    thread = threading.Thread(target=loop.run_until_complete, args=(serve(),))
    thread.start()
    assert up.wait(5)
    try:
        yield line, f"http://127.0.0.1:{ports[0]}/"
    finally:
        loop.call_soon_threadsafe(down.set)
        thread.join(10)
        loop.close()
