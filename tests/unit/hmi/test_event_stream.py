"""Readers of the live view that stop reading: they are dropped, and hold no place and no memory."""

import socket
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

from tests.unit.hmi.conftest import TOKEN
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.scripted_daemon import PaperDaemon, page_thread, serving, snapshot

SILENT_READERS = 3


def silent_reader(url: str) -> socket.socket:
    """Asks for the events, and reads none."""
    address = urlsplit(url)
    connection = socket.socket()
    # Little room at this end, so that the page's end is what fills.
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.settimeout(30)
    connection.connect((address.hostname, address.port))
    head = f"GET /api/v1/events HTTP/1.1\r\nHost: {address.netloc}\r\n"
    connection.sendall(f"{head}Authorization: Bearer {TOKEN}line\r\n\r\n".encode())
    return connection


def test_who_reads_nothing_is_dropped_and_makes_room(settings: Path, paper: PaperDaemon) -> None:
    # More than all buffers on the way hold, within a few snapshots.
    paper.snapshot = snapshot(links={f"device {i}": "x" * 1000 for i in range(300)})
    with (
        serving(settings.parent / "s", paper),
        page_thread(settings, take_timeout_ms=500) as url,
        ExitStack() as held,
    ):
        client = Client(url)
        client.until_live()
        for _ in range(SILENT_READERS):
            held.enter_context(silent_reader(url))
        client.until(lambda: client.get("health").json["pages_open"] == SILENT_READERS)
        client.until(lambda: client.get("health").json["pages_open"] == 0)
        assert client.get("status").status == 200
