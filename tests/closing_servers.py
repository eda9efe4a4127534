"""A pytest plugin: a server that closes leaves no accepted connection open.

asyncio serves a connection in the turn of the loop after the one that accepted it. If the server is
closed between the two, CPython drops the connection without closing its socket
(https://github.com/python/cpython/issues/109564, open in 3.11 to 3.14). The interpreter closes it a
moment later with a ``ResourceWarning``. That is harmless in a program, but an error in these tests,
and in whichever of them happens to run then. Fakes and proxies are closed while their clients still
call, so this was met once in every few thousand tests.
"""

import asyncio
import socket
from asyncio.selector_events import BaseSelectorEventLoop
from typing import Any

import pytest

_serve = BaseSelectorEventLoop._accept_connection2  # type: ignore[attr-defined]


async def _serve_if_open(
    loop: BaseSelectorEventLoop,
    protocol_factory: Any,
    connection: socket.socket,
    extra: Any,
    sslcontext: Any = None,
    server: asyncio.Server | None = None,
    *timeouts_s: float,
) -> None:
    # Nothing is awaited from here until the transport has the connection.
    if server is not None and not server.sockets:
        connection.close()
        return
    await _serve(loop, protocol_factory, connection, extra, sslcontext, server, *timeouts_s)


def pytest_configure(config: pytest.Config) -> None:
    BaseSelectorEventLoop._accept_connection2 = _serve_if_open  # type: ignore[attr-defined]
