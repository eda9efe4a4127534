"""Many readers of the live view in one process, and how late each snapshot came to them."""

import asyncio
import hashlib
import json
import time
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from urllib.parse import urlsplit

STREAMS_EACH = 4
"""As many as the page lets one session have."""


def token(number: int) -> str:
    """Of the program with this number."""
    return f"reader-{number:03d}-of-the-benchmark"


def add_readers(settings: Path, count: int) -> None:
    """Let so many streams be opened: programs with tokens, each with its share."""
    programs = [
        f'[[tokens]]\nname = "reader-{number}"\nrole = "view"\nexpires = 2099-12-31\n'
        f'sha256 = "{hashlib.sha256(token(number).encode()).hexdigest()}"\n'
        for number in range(-(-count // STREAMS_EACH))
    ]
    settings.write_text(settings.read_text("utf-8") + "\n" + "\n".join(programs), "utf-8")


@dataclass
class Heard:
    """What all readers have heard."""

    late_s: list[float] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)


def read(pipe: Connection, url: str, count: int) -> None:
    """The target of a process: says when all are connected, reads until told, sends ``Heard``."""
    asyncio.run(_read_all(pipe, url, count))


async def _read_all(pipe: Connection, url: str, count: int) -> None:
    heard = Heard()
    connected = asyncio.Semaphore(0)
    address = urlsplit(url)
    assert address.hostname is not None
    where = address.hostname, address.port or 80
    tasks = [asyncio.create_task(_read(where, one, heard, connected)) for one in range(count)]
    for _ in range(count):
        await connected.acquire()
    heard.late_s.clear()
    pipe.send("connected")
    await asyncio.to_thread(pipe.recv)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    pipe.send(heard)


async def _read(
    where: tuple[str, int], number: int, heard: Heard, connected: asyncio.Semaphore
) -> None:
    reader, writer = await asyncio.open_connection(*where, limit=1 << 20)
    secret = token(number // STREAMS_EACH)
    head = f"GET /api/v1/events HTTP/1.1\r\nHost: {where[0]}\r\nAuthorization: Bearer {secret}\r\n"
    writer.write(f"{head}\r\n".encode())
    status = await reader.readline()
    if b" 200 " not in status:
        heard.refused.append(status.decode().strip())
    connected.release()
    try:
        kind = b""
        while line := await reader.readline():
            if line.startswith(b"event: "):
                kind = line[7:].strip()
            elif line.startswith(b"data: ") and kind == b"snapshot":
                heard.late_s.append(time.monotonic() - json.loads(line[6:])["mono_s"])
    finally:
        writer.transport.abort()
