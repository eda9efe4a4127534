"""A server that answers each request with what a script returns, byte for byte."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

Script = Callable[[bytes], bytes | None]
"""A request becomes the bytes of the answer; None closes the connection instead."""


@asynccontextmanager
async def serving(
    read_request: Callable[[asyncio.StreamReader], Awaitable[bytes]], script: Script
) -> AsyncIterator[int]:
    """Serve on a free port of this PC, which is what the context gives."""
    tasks: set[asyncio.Task[None]] = set()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            # a client that goes ends its connection, nothing else
            with suppress(asyncio.IncompleteReadError, ConnectionError):
                while (answer := script(await read_request(reader))) is not None:
                    writer.write(answer)
        finally:
            writer.close()
            await asyncio.gather(writer.wait_closed(), return_exceptions=True)

    def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.create_task(serve(reader, writer))
        tasks.add(task)
        # A task that is cancelled before its first turn closes nothing.
        task.add_done_callback(lambda _: writer.transport.abort())

    server = await asyncio.start_server(accept, "127.0.0.1", 0)
    try:
        yield int(server.sockets[0].getsockname()[1])
    finally:
        server.close()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
