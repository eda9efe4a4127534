"""The producer has a fake cell expose here: one request and one answer for each exposure.

Messages on a local socket, laid out as in ``producer/cell_images.h``; an image comes with its
answer as a descriptor of memory, so its bytes never pass through the socket.
"""

import asyncio
import os
import socket
import struct
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Final
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from fakes.gentl.formats import FORMATS, Format

_REQUEST: Final = struct.Struct("<4s7IddQ")
_ANSWER: Final = struct.Struct("<4s5I")
_PIECE: Final = 1 << 20
"""Bytes of an image that are written at once: they take half a millisecond of the event loop,
which also keeps the time of the cell."""


class Outcome(IntEnum):
    """What becomes of an exposure at the producer."""

    WHOLE = 0
    INCOMPLETE = 1
    """Packets of the image are missing."""
    STALE = 2
    """The image before, delivered again."""
    LOST = 3
    """The camera falls off the network; opened anew, it is there again."""


@dataclass(frozen=True, slots=True)
class Asked:
    """One exposure as the registers of the camera have it."""

    camera: int
    """Its place in the file of cameras."""
    offset_px: tuple[int, int]
    """Offset of the region that is read out: x, y."""
    size_px: tuple[int, int]
    """Width, height."""
    pixel_format: Format
    exposure_us: float
    gain_db: float
    begun_s: float
    """Monotonic time."""


@dataclass(frozen=True, slots=True, eq=False)
class Exposed:
    """What the camera delivers; its bytes are laid out in the format that was asked for."""

    outcome: Outcome
    size_px: tuple[int, int] = (0, 0)
    data: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))


Expose = Callable[[Asked], Awaitable[Exposed | None]]
"""Exposes one camera; None for a camera that delivers nothing."""


class ExposureServer:
    """Answers the producer, a connection for each camera that is open."""

    def __init__(self, expose: Expose) -> None:
        self.address: Final = f"cellctl-fake-cell-{uuid4().hex}"
        """Name in the abstract namespace of sockets: it has no file, and ends with this process."""
        self._expose = expose
        self._task: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Listen. Idempotent."""
        if self._task is not None:
            return
        server = _seqpacket()
        server.bind(f"\0{self.address}")
        server.listen()
        self._task = asyncio.create_task(self._accept(server))

    async def stop(self) -> None:
        """Hang up; the cameras are gone then. Idempotent."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.wait({task})
            if not task.cancelled():
                task.result()

    async def _accept(self, server: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        with server:
            async with asyncio.TaskGroup() as connections:
                while True:
                    connection, _ = await loop.sock_accept(server)
                    connections.create_task(self._serve(connection))

    async def _serve(self, connection: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        with connection:
            while message := await loop.sock_recv(connection, _REQUEST.size):
                exposed = await self._expose(_asked(message))
                if exposed is None:
                    continue  # the producer hangs up when the acquisition ends
                try:
                    await _answer(connection, exposed)
                except (BrokenPipeError, ConnectionResetError):
                    return  # the acquisition has ended meanwhile


def _seqpacket() -> socket.socket:
    return socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_NONBLOCK)


def _asked(message: bytes) -> Asked:
    magic, camera, x, y, width, height, number, _, *settings, begun_ns = _REQUEST.unpack(message)
    if magic != b"FCGQ":
        raise ValueError(f"request {message!r} of a fake producer")
    exposure_us, gain_db = settings
    return Asked(
        camera=camera,
        offset_px=(x, y),
        size_px=(width, height),
        pixel_format=FORMATS[number],
        exposure_us=exposure_us,
        gain_db=gain_db,
        begun_s=begun_ns * 1e-9,
    )


async def _answer(connection: socket.socket, exposed: Exposed) -> None:
    size = len(exposed.data)
    answer = _ANSWER.pack(b"FCGA", exposed.outcome, *exposed.size_px, size, 0)
    block = os.memfd_create("fake-image", os.MFD_CLOEXEC)
    try:
        # A thread would wait for a processor beside busy programs; the event loop does not.
        left = exposed.data.data
        while left:
            left = left[os.write(block, left[:_PIECE]) :]
            await asyncio.sleep(0)
        socket.send_fds(connection, [answer], [block])
    finally:
        os.close(block)
