"""The fake frame server of a stereo head: CFS/1 of docs/protocols/frame-server.md.

The scene is taken when the request arrives; rendering runs in a pool of worker processes, so the
event loop of the fake cell never waits for it.
"""

import asyncio
import struct
import zlib
from collections.abc import AsyncIterator, Callable
from concurrent.futures import BrokenExecutor, Executor
from dataclasses import dataclass, replace
from typing import Final

from fakes.render.options import RenderOptions
from fakes.render.worker import render_frame
from fakes.wire.frame_server_faults import FrameFaults
from fakes.world.scene import CameraScene

_REQUEST: Final = struct.Struct(">4sHHII")
_REPLY: Final = struct.Struct(">4sHHIIQIHHHHII")
_CRC: Final = struct.Struct(">I")
_VERSION: Final = 1
_IDENTIFY, _GRAB = 1, 2
_OK, _BUSY, _CAMERA_FAULT, _BAD_REQUEST = 0, 1, 2, 3
_MONO8: Final = 1
_CHUNK: Final = 1 << 18
_SEND_TIMEOUT_S: Final = 20.0
_ENDS: Final = (ConnectionError, asyncio.IncompleteReadError, TimeoutError)
"""How a client goes: closed, closed within a request, or no longer reading."""
_DEPARTURE_S: Final = 0.1
"""A newcomer waits this long for a client that has just closed its end."""


@dataclass(frozen=True, slots=True)
class _Reply:
    request_id: int
    status: int = _OK
    frame_id: int = 0
    time_us: int = 0
    exposure_us: int = 0
    width: int = 0
    height: int = 0
    images: int = 0
    payload: bytes = b""
    payload_crc: int = 0

    def header(self) -> bytes:
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
            _MONO8,
            len(self.payload),
            self.payload_crc,
        )
        return fields + _CRC.pack(zlib.crc32(fields))


class FrameServer:
    """Serves one head to one client at a time."""

    def __init__(
        self,
        host: str,
        port: int,
        scene: Callable[[], CameraScene],
        pool: Executor,
        *,
        options: RenderOptions | None = None,
        identity: str = "fake-head;FH-0001;1.0",
        exposure_us: int = 8000,
    ) -> None:
        """``scene`` is called in the event loop at every grab; ``pool`` runs ``render_frame``.

        ``identity`` is ``model;serial;firmware``. Port 0 takes any free one.
        """
        self.faults = FrameFaults()
        self._host, self._port = host, port
        self._scene = scene
        self._pool = pool
        self._options = options or RenderOptions()
        self._identity = identity.encode()
        self._exposure_us = exposure_us
        self._frame_id = 0
        self._last: _Reply | None = None
        self._server: asyncio.Server | None = None
        self._client: asyncio.Task[None] | None = None

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
            elif command == _GRAB and zero == 0:
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
                await self._send(writer, _Reply(request_id, _BAD_REQUEST), {})

    def _identify(self, request_id: int) -> _Reply:
        crc = zlib.crc32(self._identity)
        return _Reply(request_id, payload=self._identity, payload_crc=crc)

    async def _grab(self, request_id: int, faults: dict[str, float]) -> _Reply:
        for name, status in (("busy", _BUSY), ("camera_fault", _CAMERA_FAULT)):
            if name in faults:
                return _Reply(request_id, status)
        if "frozen" not in faults or self._last is None:
            try:
                self._last = await self._expose(frozenset(faults))
            except BrokenExecutor:
                return _Reply(request_id, _CAMERA_FAULT)
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

    async def _expose(self, faults: frozenset[str]) -> _Reply:
        scene = self._scene()
        self._frame_id += 1
        frame_id = self._frame_id
        loop = asyncio.get_running_loop()
        frame = await loop.run_in_executor(self._pool, render_frame, scene, self._options, faults)
        return _Reply(
            request_id=0,
            frame_id=frame_id,
            time_us=round(scene.time_s * 1e6),
            exposure_us=self._exposure_us,
            width=frame.width,
            height=frame.height,
            images=2,
            payload=frame.payload,
            payload_crc=frame.crc,
        )

    async def _send(
        self, writer: asyncio.StreamWriter, reply: _Reply, faults: dict[str, float]
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


def _quartered(reply: _Reply) -> _Reply:
    """The first quarter of both images, as if a region of interest had been left set."""
    width, height = reply.width // 2, reply.height // 2
    rows = [
        reply.payload[start : start + width]
        for image in range(2)
        for start in range(
            image * reply.width * reply.height,
            image * reply.width * reply.height + height * reply.width,
            reply.width,
        )
    ]
    payload = b"".join(rows)
    return replace(
        reply, width=width, height=height, payload=payload, payload_crc=zlib.crc32(payload)
    )
