"""CFS/1 with a single camera: golden frames at both ends, and every fault of device and wire."""

import asyncio
import struct
import zlib
from collections.abc import AsyncIterator
from dataclasses import dataclass

import numpy as np
import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import DeviceFault, LinkError, LinkLost, ProtocolViolation, ReplyTimeout
from cellctl.interfaces.camera import PixelFormat
from drivers.camera.frame_server import protocol
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerCamera, FrameServerHead
from drivers.camera.frame_server.protocol import ServerCommand
from fakes.wire.cameras.image_server import ImageServer, Picture
from tests.rigs.wire.proxy import ChaosProxy
from tests.wire.cameras import cfs_golden as golden
from tests.wire.cameras.camera_bench import HEIGHT, WIDTH, PictureTaker


@dataclass
class CameraRig:
    camera: FrameServerCamera
    server: ImageServer
    wire: ChaosProxy


@pytest.fixture
async def rig() -> AsyncIterator[CameraRig]:
    server = ImageServer("127.0.0.1", 0, PictureTaker(PixelFormat.RGB8).take)
    await server.start()
    async with ChaosProxy(server.port) as wire:
        settings = FrameServerConfig(host="127.0.0.1", port=wire.port, reply_timeout_s=0.5)
        camera = FrameServerCamera("eye", settings)
        await camera.connect()
        yield CameraRig(camera, server, wire)
        await camera.disconnect()
    if server._client is not None:  # let it notice that its client has gone
        await asyncio.wait({server._client}, timeout=2.0)
    await server.stop()


async def good(camera: FrameServerCamera) -> None:
    """An image comes, at the latest when the server has noticed the end of the last connection."""
    async with asyncio.timeout(5.0):
        while True:
            try:
                image = await camera.grab()
            except LinkLost:
                continue
            assert image.pixels.shape == (HEIGHT, WIDTH, 3)
            return


def test_golden_frames_in_the_codec() -> None:
    assert protocol.request(ServerCommand.GRAB_IMAGE, 7) == golden.IMAGE_REQUEST
    assert protocol.request(ServerCommand.GRAB_PAIR, 8) == golden.PAIR_REQUEST
    header = protocol.parse_header(golden.IMAGE_HEADER, ServerCommand.GRAB_IMAGE, 7)
    protocol.check_payload(header, golden.IMAGE_PAYLOAD)
    assert (header.frame_id, header.exposure_time_us, header.exposure_us) == (5, 1_000_000, 8000)
    pixels, pixel_format = protocol.to_pixels(header, golden.IMAGE_PAYLOAD)
    assert pixel_format is PixelFormat.RGB8
    assert pixels.tolist() == [[[255, 128, 0], [0, 0, 255]]]
    header = protocol.parse_header(golden.PAIR_HEADER, ServerCommand.GRAB_PAIR, 8)
    protocol.check_payload(header, golden.PAIR_PAYLOAD)
    left, right = protocol.split_images(header, golden.PAIR_PAYLOAD)
    assert (left.tolist(), right.tolist()) == ([[16, 32]], [[48, 64]])


async def test_golden_frames_from_the_fake() -> None:
    async def take(faults: frozenset[str]) -> Picture:
        return Picture(2, 1, golden.IMAGE_PAYLOAD, 1.0, 3)

    server = ImageServer("127.0.0.1", 0, take)
    server._frame_id = 4
    await server.start()
    reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
    async with asyncio.timeout(2.0):
        writer.write(golden.IMAGE_REQUEST + golden.PAIR_REQUEST)
        expected = golden.IMAGE_HEADER + golden.IMAGE_PAYLOAD + golden.REFUSAL
        assert await reader.readexactly(len(expected)) == expected
    writer.close()
    await writer.wait_closed()
    await server.stop()


def test_samples_of_16_bit_come_in_network_order() -> None:
    payload = bytes.fromhex("0102ffee")
    fields = struct.pack(">4sHHIIQIHHHHII", b"CFSR", 1, 0, 1, 1, 1, 1, 2, 1, 1, 2, 4,
                         zlib.crc32(payload))  # fmt: skip
    data = fields + struct.pack(">I", zlib.crc32(fields))
    header = protocol.parse_header(data, ServerCommand.GRAB_IMAGE, 1)
    pixels, _ = protocol.to_pixels(header, payload)
    assert pixels.dtype == np.uint16
    assert pixels.tolist() == [[0x0102, 0xFFEE]]
    with pytest.raises(ProtocolViolation):  # a pair has two images, and 8 bit
        protocol.parse_header(data, ServerCommand.GRAB_PAIR, 1)


async def test_a_head_is_no_camera_and_a_camera_is_no_head(rig: CameraRig) -> None:
    await rig.camera.disconnect()
    settings = FrameServerConfig(host="127.0.0.1", port=rig.wire.port, reply_timeout_s=0.5)
    head = FrameServerHead("head_1", settings)
    async with asyncio.timeout(5.0):
        while True:  # until the server has noticed that the camera's client has gone
            try:
                await head.connect()
                break
            except LinkLost:
                continue
    with pytest.raises(DeviceFault, match="not understood"):
        await head.grab()
    await head.disconnect()


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("silent", ReplyTimeout), ("half_open", ReplyTimeout), ("hang_up", LinkLost),
     ("corrupt_payload", ProtocolViolation), ("corrupt_header", ProtocolViolation),
     ("truncated", LinkLost), ("wrong_id", ProtocolViolation), ("busy", DeviceFault),
     ("camera_fault", DeviceFault), ("frozen", ProtocolViolation)],
)  # fmt: skip
async def test_faults_of_the_camera(rig: CameraRig, fault: str, expected: type[CellError]) -> None:
    await rig.camera.grab()
    rig.server.faults.inject(fault, replies=1)
    with pytest.raises(expected):
        await rig.camera.grab()
    await good(rig.camera)


async def test_a_late_or_dribbled_reply_is_waited_for(rig: CameraRig) -> None:
    rig.server.faults.inject("late", 0.2, replies=1)
    await rig.camera.grab()
    rig.server.faults.inject("dribbled", 1, replies=1)
    await rig.camera.grab()


async def test_a_smaller_image_is_what_the_camera_says_it_is(rig: CameraRig) -> None:
    rig.server.faults.inject("wrong_size", replies=1)
    image = await rig.camera.grab()
    assert image.pixels.shape == (HEIGHT // 2, WIDTH // 2, 3)
    whole = (await rig.camera.grab()).pixels
    assert np.array_equal(image.pixels + np.uint8(1), whole[: HEIGHT // 2, : WIDTH // 2])


async def test_split_and_merged_packets_change_nothing(rig: CameraRig) -> None:
    rig.wire.forth.split = rig.wire.back.split = True
    await rig.camera.grab()
    rig.wire.back.split = False
    rig.wire.back.merge_bytes = 48 + 3 * WIDTH * HEIGHT  # header and payload in one piece
    await rig.camera.grab()


async def test_each_byte_of_a_reply_is_guarded(rig: CameraRig) -> None:
    for at in (0, 7, 20, 33, 35, 47, 48, 60, 48 + 3 * WIDTH * HEIGHT - 1):
        rig.wire.back.corrupt_in = at
        with pytest.raises(ProtocolViolation):
            await rig.camera.grab()
        await good(rig.camera)
        rig.wire.back.corrupt_in = None


async def test_a_byte_that_changes_in_the_request(rig: CameraRig) -> None:
    rig.wire.forth.corrupt_in = 7
    with pytest.raises(LinkError):
        await rig.camera.grab()
    await good(rig.camera)


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_half_open_wire(rig: CameraRig, direction: str) -> None:
    getattr(rig.wire, direction).blocked = True
    with pytest.raises(ReplyTimeout):
        await rig.camera.grab()
    getattr(rig.wire, direction).blocked = False
    rig.wire.reset()
    await good(rig.camera)
