"""A server that closes while somebody calls leaves no socket open, whatever turn it is."""

import asyncio
import gc
import socket
import warnings
from collections.abc import Iterator

import pytest

TURNS = range(8)
"""asyncio needs five from a client's connection to the coroutine that serves it."""


@pytest.fixture(autouse=True)
def young_garbage() -> Iterator[None]:
    """What becomes garbage stays in the youngest generation, which is collected at no cost."""
    gc.collect(0)
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


@pytest.mark.parametrize("turns", TURNS)
async def test_a_connection_that_nobody_serves_is_closed(turns: int) -> None:
    served: list[asyncio.StreamWriter] = []
    server = await asyncio.start_server(lambda _, writer: served.append(writer), "127.0.0.1", 0)
    with socket.create_connection(server.sockets[0].getsockname()):
        for _ in range(turns):
            await asyncio.sleep(0)
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            server.close()
            for _ in TURNS:
                await asyncio.sleep(0)
            gc.collect(0)
        for writer in served:
            writer.transport.abort()
        await asyncio.sleep(0)
    assert [str(one.message) for one in seen] == []
