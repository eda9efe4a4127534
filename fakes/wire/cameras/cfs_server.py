"""What the fake frame servers of stereo heads and single cameras share: CFS/1 on the wire.

Written from docs/protocols/frame-server.md only. A server says which command its cameras answer and
how they expose; connections, replies and faults are handled here.
"""

import asyncio
import struct
import zlib
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from fakes.wire.cameras.frame_server_faults import FrameFaults
from fakes.wire.cameras.rendering import ExposureError

_REQUEST: Final = struct.Struct(">4sHHII")
_REPLY: Final = struct.Struct(">4sHHIIQIHHHHII")
_CRC: Final = struct.Struct(">I")
_VERSION: Final = 1
_IDENTIFY: Final = 1
_OK, _BUSY, _CAMERA_FAULT, _BAD_REQUEST = 0, 1, 2, 3
MONO8, MONO16, RGB8 = 1, 2, 3
_PIXEL_BYTES: Final = {MONO8: 1, MONO16: 2, RGB8: 3}
_CHUNK: Final = 1 << 18
_SEND_TIMEOUT_S: Final = 20.0
_ENDS: Final = (ConnectionError, asyncio.IncompleteReadError, TimeoutError)
"""How a client goes: closed, closed within a request, or no longer reading."""
_DEPARTURE_S: Final = 0.1
"""A newcomer waits this long for a client that has just closed its end."""


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply before it becomes bytes. The CRC is kept apart from the payload, so that a fault can
    spoil one without the other."""

    request_id: int
    status: int = _OK
    frame_id: int = 0
    time_us: int = 0
    exposure_us: int = 0
    width: int = 0
    height: int = 0
    images: int = 0
    pixel_format: int = MONO8
    payload: bytes = b""
    payload_crc: int = 0

    def header(self) -> bytes:
        """The 48 bytes before the payload."""
        fields = _REPLY.pack(
            b"CFSR",
            _VERSION,
            self.status,
            self.request_id,
            self.frame_id,
            self.time_us,
            self.exposure_us,
            self.width,
            self.height,
            self.images,
            self.pixel_format,
            len(self.payload),
            self.payload_crc,
        )
        return fields + _CRC.pack(zlib.crc32(fields))


class CfsServer(ABC):
    """Serves one client at a time."""

    grab_command: int
    """The command of the protocol that the cameras behind this server answer."""

    def __init__(self, host: str, port: int, identity: str) -> None:
        """``identity`` is ``model;serial;firmware``. Port 0 takes any free one."""
        self.faults = FrameFaults()
        self._host, self._port = host, port
        self._identity = identity.encode()
        self._last: Reply | None = None
        self._server: asyncio.Server | None = None
        self._client: asyncio.Task[None] | None = None

    @abstractmethod
    async def expose(self, faults: frozenset[str]) -> Reply:
        """Take the picture that a grab asks for, with the number of its frame; ``faults`` are names
        of the faults of scene and picture. Raises ``ExposureError``."""

    @property
    def port(self) -> int:
        """The port in use, once started."""
        if self._server is None:
            raise RuntimeError("the frame server is not started")
        return int(self._server.sockets[0].getsockname()[1])

    async def start(self) -> None:
        """Listen; ``OSError`` when the port is taken."""
        self._server = await asyncio.start_server(self._connected, self._host, self._port)

    async def stop(self) -> None:
        """Drop the client and stop listening. Idempotent."""
        server, self._server = self._server, None
        if server is None:
            return
        server.close()
        if self._client is not None:
            self._client.cancel()
            await asyncio.gather(self._client, return_exceptions=True)
        await server.wait_closed()

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._client is not None:
            await asyncio.wait({self._client}, timeout=_DEPARTURE_S)
        if self._client is not None:
            writer.close()
            return
        self._client = asyncio.current_task()
        requests: asyncio.Queue[bytes] = asyncio.Queue()
        jobs = {
            asyncio.create_task(_read(reader, requests)),
            asyncio.create_task(self._answer(requests, writer)),
        }
        try:
            await asyncio.wait(jobs, return_when=asyncio.FIRST_COMPLETED)
        except asyncio.CancelledError:
            writer.transport.abort()  # the server stops
        finally:
            for job in jobs:
                job.cancel()
            outcomes = await asyncio.gather(*jobs, return_exceptions=True)
            writer.close()
            self._client = None
        for outcome in outcomes:
            if isinstance(outcome, Exception) and not isinstance(outcome, _ENDS):
                raise outcome

    async def _answer(self, requests: asyncio.Queue[bytes], writer: asyncio.StreamWriter) -> None:
        """Answer until a fault or a violation ends the connection."""
        while True:
            magic, version, command, request_id, zero = _REQUEST.unpack(await requests.get())
            if magic != b"CFSQ" or version != _VERSION:
                return
            if command == _IDENTIFY and zero == 0:
                await self._send(writer, self._identify(request_id), {})
            elif command == self.grab_command and zero == 0:
                faults = self.faults.take()
                if "hang_up" in faults:
                    return
                if "half_open" in faults:
                    await asyncio.Event().wait()  # ended by the client's going
                if "silent" not in faults:
                    reply = await self._grab(request_id, faults)
                    await self._send(writer, reply, faults)
                    if "truncated" in faults:
                        return
            else:
                await self._send(writer, Reply(request_id, _BAD_REQUEST), {})

    def _identify(self, request_id: int) -> Reply:
        crc = zlib.crc32(self._identity)
        return Reply(request_id, payload=self._identity, payload_crc=crc)

    async def _grab(self, request_id: int, faults: dict[str, float]) -> Reply:
        for name, status in (("busy", _BUSY), ("camera_fault", _CAMERA_FAULT)):
            if name in faults:
                return Reply(request_id, status)
        if "frozen" not in faults or self._last is None:
            try:
                self._last = await self.expose(frozenset(faults))
            except ExposureError:
                return Reply(request_id, _CAMERA_FAULT)
        reply = replace(self._last, request_id=request_id)
        if "wrong_size" in faults:
            reply = _quartered(reply)
        if "wrong_id" in faults:
            reply = replace(reply, request_id=(request_id + 1) % 2**32)
        if "corrupt_payload" in faults:
            flipped = bytearray(reply.payload)
            flipped[len(flipped) // 3] ^= 0x10
            reply = replace(reply, payload=bytes(flipped))
        return reply

    async def _send(
        self, writer: asyncio.StreamWriter, reply: Reply, faults: dict[str, float]
    ) -> None:
        await asyncio.sleep(faults.get("late", 0.0))
        header, payload = reply.header(), memoryview(reply.payload)
        if "corrupt_header" in faults:
            header = header[:21] + bytes([header[21] ^ 0x04]) + header[22:]
        if "truncated" in faults:
            payload = payload[: len(payload) // 2]
        async with asyncio.timeout(_SEND_TIMEOUT_S):
            async for piece in _pieces(header, payload, faults):
                writer.write(piece)
                await writer.drain()


async def _pieces(
    header: bytes, payload: memoryview, faults: dict[str, float]
) -> AsyncIterator[bytes | memoryview]:
    """The reply cut for sending; dribbled, the header comes in two parts and pauses are made."""
    dribbled = "dribbled" in faults
    size = max(int(faults["dribbled"]), 1 << 12) if dribbled else _CHUNK
    cut = 7 if dribbled else len(header)
    for part in (header[:cut], header[cut:]):
        yield part
        await asyncio.sleep(0.02 if dribbled else 0)
    for start in range(0, len(payload), size):
        yield payload[start : start + size]
        if dribbled:
            await asyncio.sleep(0.002)


async def _read(reader: asyncio.StreamReader, requests: asyncio.Queue[bytes]) -> None:
    """Read ahead, so that the end of the connection is noticed during a reply too."""
    while True:
        requests.put_nowait(await reader.readexactly(_REQUEST.size))


def _quartered(reply: Reply) -> Reply:
    """The first quarter of each image, as if a region of interest had been left set."""
    shape = (reply.images, reply.height, reply.width, _PIXEL_BYTES[reply.pixel_format])
    pixels = np.frombuffer(reply.payload, np.uint8).reshape(shape)
    width, height = reply.width // 2, reply.height // 2
    payload = pixels[:, :height, :width].tobytes()
    return replace(
        reply, width=width, height=height, payload=payload, payload_crc=zlib.crc32(payload)
    )
