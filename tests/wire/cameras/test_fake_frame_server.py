"""The fake head against docs/protocols/frame-server.md, byte by byte, with a client of its own."""

import asyncio
import itertools
import os
import struct
import zlib
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fakes.priority import RENDERER_NICE
from fakes.render import api
from fakes.render.worker import make_pool, render_frame
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.frame_server_faults import FrameFaults
from fakes.world.scene import CameraScene, LensTruth, StereoTruth

SIZE = (260, 200)
TIMEOUT_S = 20.0


@dataclass
class Reply:
    status: int
    request_id: int
    frame_id: int
    time_us: int
    exposure_us: int
    size: tuple[int, int]
    images: int
    pixel_format: int
    payload: bytes
    header_ok: bool
    payload_ok: bool

    @property
    def pair(self) -> tuple[np.ndarray, np.ndarray]:
        width, height = self.size
        pixels = np.frombuffer(self.payload, np.uint8).reshape(2, height, width)
        return pixels[0], pixels[1]


class Client:
    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    def ask(self, command: int, request_id: int, *, magic: bytes = b"CFSQ") -> None:
        self.writer.write(struct.pack(">4sHHII", magic, 1, command, request_id, 0))

    async def reply(self) -> Reply:
        async with asyncio.timeout(TIMEOUT_S):
            header = await self.reader.readexactly(48)
            assert header[:6] == b"CFSR\x00\x01"
            status, request_id, frame_id = struct.unpack(">HII", header[6:16])
            time_us, exposure_us = struct.unpack(">QI", header[16:28])
            width, height, images, pixel_format = struct.unpack(">HHHH", header[28:36])
            length, payload_crc, header_crc = struct.unpack(">III", header[36:48])
            payload = await self.reader.readexactly(length)
        return Reply(
            status,
            request_id,
            frame_id,
            time_us,
            exposure_us,
            (width, height),
            images,
            pixel_format,
            payload,
            zlib.crc32(header[:44]) == header_crc,
            zlib.crc32(payload) == payload_crc,
        )

    async def grab(self, request_id: int = 1) -> Reply:
        self.ask(2, request_id)
        return await self.reply()

    async def at_end(self) -> bool:
        async with asyncio.timeout(TIMEOUT_S):
            return await self.reader.read(1) == b""


def small_head() -> StereoTruth:
    """A head whose images are cut out of the full ones round pin hole P1."""
    stereo = api.nominal_head()
    places = api.project_hole_centres(stereo, api.nominal_plate("deck"))["P1"]

    def crop(lens: LensTruth, place: np.ndarray) -> LensTruth:
        x, y = lens.centre_px
        return replace(lens, centre_px=(x - place[0] + SIZE[0] / 2, y - place[1] + SIZE[1] / 2))

    left, right = crop(stereo.left, places[0]), crop(stereo.right, places[1])
    return replace(stereo, image_size_px=SIZE, left=left, right=right)


def scenes() -> Callable[[], CameraScene]:
    stereo, deck = small_head(), api.nominal_plate("deck")
    counter = itertools.count()

    def scene() -> CameraScene:
        number = next(counter)
        return CameraScene(
            camera="head_1",
            time_s=12.5 + number,
            optics=stereo,
            bodies=(deck,),
            light_seed=1,
            noise_seed=100 + number,
        )

    return scene


@pytest.fixture(scope="module")
def threads() -> Iterator[Executor]:
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture
async def server(threads: Executor) -> AsyncIterator[FrameServer]:
    running = FrameServer("127.0.0.1", 0, scenes(), threads, identity="RVC;X1;2.0")
    await running.start()
    yield running
    await running.stop()


@pytest.fixture
async def client(server: FrameServer) -> AsyncIterator[Client]:
    link = await connect(server)
    yield link
    link.writer.close()


async def connect(server: FrameServer) -> Client:
    return Client(*await asyncio.open_connection("127.0.0.1", server.port))


async def test_identify(client: Client) -> None:
    client.ask(1, 77)
    reply = await client.reply()
    assert (reply.status, reply.request_id, reply.frame_id) == (0, 77, 0)
    assert (reply.images, reply.payload) == (0, b"RVC;X1;2.0")
    assert reply.header_ok
    assert reply.payload_ok


async def test_grab_carries_both_images_of_the_scene_at_the_request(client: Client) -> None:
    reply = await client.grab(5)
    assert (reply.status, reply.request_id, reply.frame_id) == (0, 5, 1)
    assert (reply.size, reply.images, reply.pixel_format) == (SIZE, 2, 1)
    assert (reply.time_us, reply.exposure_us) == (12_500_000, 8000)
    assert reply.header_ok
    assert reply.payload_ok
    expected = render_frame(scenes()(), api.RenderOptions())
    assert reply.payload == expected.payload


async def test_frames_count_up_and_only_the_noise_differs(client: Client) -> None:
    first, second = await client.grab(1), await client.grab(2)
    assert second.frame_id == first.frame_id + 1
    assert second.time_us - first.time_us == 1_000_000
    difference = first.pair[0].astype(float) - second.pair[0]
    assert 1.5 < difference.std() < 5.0
    assert abs(difference.mean()) < 0.1


async def test_unknown_command_is_refused_and_the_link_stays(client: Client) -> None:
    client.ask(9, 3)
    reply = await client.reply()
    assert (reply.status, reply.request_id, reply.payload) == (3, 3, b"")
    assert (await client.grab(4)).status == 0


async def test_wrong_magic_ends_the_connection(client: Client) -> None:
    client.ask(1, 1, magic=b"HTTP")
    assert await client.at_end()


async def test_second_client_is_turned_away_while_the_first_lives(
    server: FrameServer, client: Client
) -> None:
    assert (await client.grab()).status == 0
    second = await connect(server)
    assert await second.at_end()
    second.writer.close()
    assert (await client.grab()).status == 0


async def test_new_client_after_the_first_has_gone(server: FrameServer) -> None:
    for expected in (1, 2):
        link = await connect(server)
        assert (await link.grab()).frame_id == expected
        link.writer.write_eof()
        assert await link.at_end()
        link.writer.close()


async def test_client_that_gave_up_does_not_block_the_next(
    server: FrameServer, client: Client
) -> None:
    server.faults.inject("late", 60.0, replies=1)
    client.ask(2, 1)
    client.ask(1, 2)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.6):
            await client.reader.read(1)
    client.writer.close()
    await client.writer.wait_closed()
    link = await connect(server)
    assert (await link.grab(3)).request_id == 3
    link.writer.close()


async def test_dead_worker_is_a_camera_fault() -> None:
    with ThreadPoolExecutor(1, initializer=_fail) as pool:
        server = FrameServer("127.0.0.1", 0, scenes(), pool)
        await server.start()
        link = await connect(server)
        assert (await link.grab()).status == 2
        link.writer.close()
        await server.stop()


def _fail() -> None:
    raise RuntimeError("no memory")


async def test_stop_drops_the_client_and_frees_the_port(
    server: FrameServer, client: Client, threads: Executor
) -> None:
    assert (await client.grab()).status == 0
    port = server.port
    await server.stop()
    assert await client.at_end()
    again = FrameServer("127.0.0.1", port, scenes(), threads)
    await again.start()
    await again.stop()


@pytest.mark.parametrize(("name", "status"), [("busy", 1), ("camera_fault", 2)])
async def test_status_faults(server: FrameServer, client: Client, name: str, status: int) -> None:
    server.faults.inject(name, replies=1)
    reply = await client.grab()
    assert (reply.status, reply.payload, reply.header_ok) == (status, b"", True)
    assert (await client.grab()).status == 0


async def test_silent_swallows_one_request(server: FrameServer, client: Client) -> None:
    server.faults.inject("silent", replies=1)
    client.ask(2, 1)
    assert (await client.grab(2)).request_id == 2


async def test_half_open_reads_nothing_more(server: FrameServer, client: Client) -> None:
    server.faults.inject("half_open", replies=1)
    client.ask(2, 1)
    client.ask(1, 2)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.3):
            await client.reader.read(1)
    client.writer.write_eof()
    assert await client.at_end()
    link = await connect(server)
    assert (await link.grab()).status == 0
    link.writer.close()


async def test_hang_up(server: FrameServer, client: Client) -> None:
    server.faults.inject("hang_up")
    client.ask(2, 1)
    assert await client.at_end()


async def test_late(server: FrameServer, client: Client) -> None:
    server.faults.inject("late", 0.4)
    start = asyncio.get_running_loop().time()
    assert (await client.grab()).status == 0
    assert asyncio.get_running_loop().time() - start >= 0.4


async def test_dribbled_reply_is_complete(server: FrameServer, client: Client) -> None:
    server.faults.inject("dribbled", 5000)
    client.ask(2, 1)
    async with asyncio.timeout(TIMEOUT_S):
        assert len(await client.reader.read(1 << 20)) == 7
    await client.reader.readexactly(41)
    assert len(await client.reader.readexactly(2 * SIZE[0] * SIZE[1])) > 0


async def test_corrupt_payload_and_header(server: FrameServer, client: Client) -> None:
    server.faults.inject("corrupt_payload", replies=1)
    reply = await client.grab()
    assert (reply.header_ok, reply.payload_ok) == (True, False)
    server.faults.inject("corrupt_header", replies=1)
    reply = await client.grab()
    assert (reply.header_ok, reply.payload_ok) == (False, True)


async def test_truncated(server: FrameServer, client: Client) -> None:
    server.faults.inject("truncated")
    client.ask(2, 1)
    with pytest.raises(asyncio.IncompleteReadError) as caught:
        await client.reply()
    assert len(caught.value.partial) == SIZE[0] * SIZE[1]


async def test_wrong_size_is_a_consistent_reply(server: FrameServer, client: Client) -> None:
    whole = await client.grab()
    server.faults.inject("wrong_size", replies=1)
    server.faults.inject("frozen", replies=1)
    reply = await client.grab()
    assert reply.size == (SIZE[0] // 2, SIZE[1] // 2)
    assert reply.header_ok
    assert reply.payload_ok
    np.testing.assert_array_equal(reply.pair[1], whole.pair[1][: SIZE[1] // 2, : SIZE[0] // 2])


async def test_wrong_id(server: FrameServer, client: Client) -> None:
    server.faults.inject("wrong_id")
    assert (await client.grab(8)).request_id == 9


async def test_frozen_repeats_the_last_frame(server: FrameServer, client: Client) -> None:
    first = await client.grab(1)
    server.faults.inject("frozen")
    second = await client.grab(2)
    assert second.request_id == 2
    assert (second.frame_id, second.time_us) == (first.frame_id, first.time_us)
    assert second.payload == first.payload
    server.faults.clear("frozen")
    assert (await client.grab(3)).frame_id == first.frame_id + 1


async def test_image_faults(server: FrameServer, client: Client) -> None:
    good = await client.grab()
    pictures = {}
    for name in ("black", "saturated", "swapped", "upside_down", "occluded", "no_hole"):
        server.faults.inject(name, replies=1)
        pictures[name] = (await client.grab()).pair
    left, right = (image.astype(float) for image in good.pair)
    assert pictures["black"][0].max() < 20
    assert (pictures["saturated"][1] == 255).mean() > 0.9
    assert np.abs(pictures["swapped"][0] - right).mean() < 4
    assert np.abs(pictures["upside_down"][1][::-1, ::-1] - right).mean() < 4
    assert np.abs(pictures["upside_down"][0] - left).mean() < 4
    assert pictures["occluded"][0].mean() < left.mean() - 5
    assert abs(pictures["occluded"][1].mean() - right.mean()) < 1
    hole = left < 40
    assert hole.sum() > 500
    assert pictures["no_hole"][0][hole].mean() > 100


def test_unknown_fault() -> None:
    with pytest.raises(ValueError, match="no such fault: fire"):
        FrameFaults().inject("fire")


def test_renderers_give_way_to_the_devices() -> None:
    with make_pool(1) as pool:
        niceness = pool.submit(os.getpriority, os.PRIO_PROCESS, 0).result()
    assert niceness == min(os.getpriority(os.PRIO_PROCESS, 0) + RENDERER_NICE, 19)


async def test_worker_process_renders_the_same_picture() -> None:
    with make_pool(1) as pool:
        server = FrameServer("127.0.0.1", 0, scenes(), pool)
        await server.start()
        link = await connect(server)
        reply = await link.grab()
        link.writer.close()
        await server.stop()
    here = render_frame(scenes()(), api.RenderOptions()).payload
    served, expected = (np.frombuffer(data, np.uint8).astype(int) for data in (reply.payload, here))
    different = np.abs(served - expected)
    assert different.max() <= 1, "another number of threads may round a sum the other way"
    assert (different > 0).mean() < 1e-4
