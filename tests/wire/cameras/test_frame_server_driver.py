"""The frame-server driver against scripted servers; offsets from docs/protocols/frame-server.md."""

import asyncio
import struct
import zlib
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.errors.link import (
    ConnectTimeout,
    DeviceFault,
    LinkLost,
    ProtocolViolation,
    ReplyTimeout,
)
from drivers.camera.frame_server import protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerHead
from drivers.camera.frame_server.protocol import ServerCommand
from tests.rigs.wire.ports import free_ports
from tests.wire.scripted_server import Script, serving

OFFSETS = {"version": (4, 2), "status": (6, 2), "id": (8, 4), "frame_id": (12, 4),
           "time_us": (16, 8), "width": (28, 2), "height": (30, 2), "images": (32, 2),
           "format": (34, 2), "length": (36, 4), "crc": (40, 4)}  # fmt: skip
WIDTH, HEIGHT = 6, 4
LEFT, RIGHT = bytes(range(24)), bytes(range(100, 124))


def reply(request: bytes, payload: bytes = b"", **fields: int) -> bytes:
    """A reply, put together by the offsets of the document."""
    values = {"status": 0, "frame_id": 0, "time_us": 0, "width": 0, "height": 0, "images": 0,
              "format": 1, "version": 1, "length": len(payload), "crc": zlib.crc32(payload),
              "id": int.from_bytes(request[8:12], "big")} | fields  # fmt: skip
    header = bytearray(48)
    header[0:4] = b"CFSR"
    for name, (offset, size) in OFFSETS.items():
        header[offset : offset + size] = values[name].to_bytes(size, "big")
    struct.pack_into(">I", header, 44, zlib.crc32(header[:44]))
    return bytes(header) + payload


class Server:
    """Answers as the document says, until ``script`` decides otherwise."""

    def __init__(self) -> None:
        self.frames = 0
        self.requests: list[bytes] = []
        self.script: Script = self.answer

    def __call__(self, request: bytes) -> bytes | None:
        self.requests.append(request)
        return self.script(request)

    def answer(self, request: bytes, **fields: int) -> bytes:
        if request[6:8] == b"\x00\x01":
            return reply(request, b"RVC-P5330;P-0007;2.1")
        self.frames += 1
        grab = {"frame_id": self.frames, "time_us": 1000 * self.frames, "width": WIDTH,
                "height": HEIGHT, "images": 2}  # fmt: skip
        return reply(request, LEFT + RIGHT, **(grab | fields))


async def read_request(reader: asyncio.StreamReader) -> bytes:
    return await reader.readexactly(16)


def head(port: int) -> FrameServerHead:
    settings = FrameServerConfig(host="127.0.0.1", port=port, reply_timeout_s=0.3)
    return FrameServerHead("head_1", settings)


async def test_grab() -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        assert await camera.serial_number() == "P-0007"
        pair = await camera.grab()
        assert server.requests[0] == b"CFSQ\0\1\0\1\0\0\0\1\0\0\0\0"
        assert server.requests[2] == b"CFSQ\0\1\0\2\0\0\0\3\0\0\0\0"
        assert pair.left.shape == (HEIGHT, WIDTH)
        assert pair.left.tobytes() == LEFT
        assert pair.right.tobytes() == RIGHT
        assert pair.right.dtype == np.uint8
        assert pair.frame_id == 1
        assert (await camera.grab()).frame_id == 2


def corrupted(at: int) -> Callable[[bytes], bytes]:
    return lambda answer: answer[:at] + bytes([answer[at] ^ 1]) + answer[at + 1 :]


@pytest.mark.parametrize("at", [*range(48), 48, 60, 95])
async def test_every_flipped_bit_is_seen(at: int) -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: corrupted(at)(server.answer(request))
        with pytest.raises(ProtocolViolation):
            await camera.grab()
        server.script = server.answer
        await camera.grab()


@pytest.mark.parametrize(
    "fields",
    [{"version": 2}, {"status": 9}, {"id": 77}, {"format": 2}, {"images": 1}, {"width": 7},
     {"width": 0}, {"length": 47}, {"crc": 0}],
)  # fmt: skip
async def test_fields_that_do_not_fit(fields: dict[str, int]) -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: server.answer(request, **fields)
        with pytest.raises(ProtocolViolation):
            await camera.grab()


@pytest.mark.parametrize(("status", "words"), [(1, "busy"), (2, "camera fault"), (3, "request")])
async def test_status_of_the_server(status: int, words: str) -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: reply(request, status=status)
        with pytest.raises(DeviceFault, match=words):
            await camera.grab()
        server.script = server.answer
        await camera.grab()


async def test_an_old_pair_is_refused() -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        await camera.grab()
        server.script = lambda request: server.answer(request, frame_id=1)
        with pytest.raises(ProtocolViolation, match="again"):
            await camera.grab()


async def test_a_lost_connection_fails_one_grab_only() -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: None
        with pytest.raises(LinkLost):
            await camera.grab()
        server.script = server.answer
        await camera.grab()


async def test_half_a_reply_times_out() -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: server.answer(request)[:60]
        with pytest.raises(ReplyTimeout):
            await camera.grab()


async def test_a_cancelled_grab_leaves_no_reply_behind() -> None:
    server = Server()
    async with serving(read_request, server) as port, head(port) as camera:
        server.script = lambda request: b""
        grab = asyncio.create_task(camera.grab())
        await asyncio.wait({grab}, timeout=0.05)
        grab.cancel()
        with pytest.raises(asyncio.CancelledError):
            await grab
        server.script = server.answer
        assert (await camera.grab()).frame_id == 1


async def test_nobody_listens() -> None:
    with pytest.raises(ConnectTimeout):
        await head(free_ports(1)[0]).connect()


async def test_not_connected() -> None:
    with pytest.raises(LinkLost):
        await head(9).grab()


@pytest.mark.parametrize("payload", [b"", b"a;b", b"a;b;c;d", b"\xff;b;c"])
async def test_bad_identity(payload: bytes) -> None:
    async with serving(read_request, lambda request: reply(request, payload)) as port:
        camera = head(port)
        with pytest.raises(ProtocolViolation):
            await camera.connect()
        with pytest.raises(LinkLost):
            await camera.grab()


@given(st.binary(min_size=0, max_size=60))
def test_noise_is_a_violation(data: bytes) -> None:
    with pytest.raises(ProtocolViolation):
        protocol.parse_header(data, ServerCommand.GRAB_PAIR, 1)


@given(st.binary(min_size=44, max_size=44))
def test_noise_with_a_good_crc_is_a_violation(data: bytes) -> None:
    signed = b"CFSR\0\1" + data[6:]
    with pytest.raises(ProtocolViolation):
        protocol.parse_header(
            signed + struct.pack(">I", zlib.crc32(signed)), ServerCommand.GRAB_PAIR, 1
        )


async def test_a_name_that_cannot_be_one_is_told() -> None:
    head = FrameServerHead("head", FrameServerConfig(host="head..local", port=5000))
    with pytest.raises(ConnectTimeout, match="label"):
        await head.connect()
