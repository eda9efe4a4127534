"""The drivers of the heads against their fakes: every fault of the device and of the wire."""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass

import numpy as np
import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import (
    DeviceFault,
    LinkError,
    LinkLost,
    ProtocolViolation,
    ReplyTimeout,
)
from drivers.camera.frame_server.config import FrameServerConfig
from drivers.camera.frame_server.driver import FrameServerHead
from drivers.camera.target_server.config import TargetServerConfig
from drivers.camera.target_server.driver import TargetServerTracker
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.target_server import TargetServer
from fakes.world.targets import SeenTarget
from tests.rigs.wire.proxy import ChaosProxy
from tests.wire.ramp import HEIGHT, WIDTH, Ramp


@dataclass
class HeadRig:
    head: FrameServerHead
    server: FrameServer
    wire: ChaosProxy


@pytest.fixture
async def rig() -> AsyncIterator[HeadRig]:
    pool = Ramp()
    server = FrameServer("127.0.0.1", 0, pool.scene, pool)
    await server.start()
    async with ChaosProxy(server.port) as wire:
        settings = FrameServerConfig(host="127.0.0.1", port=wire.port, reply_timeout_s=0.5)
        head = FrameServerHead("head_1", settings)
        await head.connect()
        yield HeadRig(head, server, wire)
        await head.disconnect()
    if server._client is not None:  # let it notice that its client has gone
        await asyncio.wait({server._client}, timeout=2.0)
    await server.stop()


async def good(head: FrameServerHead) -> None:
    """A pair comes, at the latest when the server has noticed the end of the last connection."""
    async with asyncio.timeout(5.0):
        while True:
            try:
                pair = await head.grab()
            except LinkLost:
                continue
            assert pair.left.shape == (HEIGHT, WIDTH)
            return


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("silent", ReplyTimeout), ("half_open", ReplyTimeout), ("hang_up", LinkLost),
     ("corrupt_payload", ProtocolViolation), ("corrupt_header", ProtocolViolation),
     ("truncated", LinkLost), ("wrong_id", ProtocolViolation), ("busy", DeviceFault),
     ("camera_fault", DeviceFault)],
)  # fmt: skip
async def test_faults_of_the_head(rig: HeadRig, fault: str, expected: type[CellError]) -> None:
    await rig.head.grab()
    rig.server.faults.inject(fault, replies=1)
    with pytest.raises(expected):
        await rig.head.grab()
    await good(rig.head)


async def test_a_late_or_dribbled_reply_is_waited_for(rig: HeadRig) -> None:
    rig.server.faults.inject("late", 0.2, replies=1)
    await rig.head.grab()
    rig.server.faults.inject("dribbled", 1, replies=1)
    await rig.head.grab()


async def test_a_frozen_head_is_seen(rig: HeadRig) -> None:
    await rig.head.grab()
    rig.server.faults.inject("frozen", replies=1)
    with pytest.raises(ProtocolViolation, match="again"):
        await rig.head.grab()


async def test_a_smaller_image_is_what_the_head_says_it_is(rig: HeadRig) -> None:
    rig.server.faults.inject("wrong_size", replies=1)
    pair = await rig.head.grab()
    assert pair.left.shape == (HEIGHT // 2, WIDTH // 2)


async def test_split_packets_change_nothing(rig: HeadRig) -> None:
    rig.wire.forth.split = rig.wire.back.split = True
    pairs = [await rig.head.grab() for _ in range(3)]
    assert not np.array_equal(pairs[0].left, pairs[1].left)


async def test_each_byte_of_a_reply_is_guarded(rig: HeadRig) -> None:
    for at in (0, 7, 20, 47, 48, 100, 143):
        rig.wire.back.corrupt_in = at
        with pytest.raises(ProtocolViolation):
            await rig.head.grab()
        await good(rig.head)
        rig.wire.back.corrupt_in = None


async def test_a_byte_that_changes_in_the_request(rig: HeadRig) -> None:
    rig.wire.forth.corrupt_in = 7
    with pytest.raises(LinkError):
        await rig.head.grab()
    await good(rig.head)


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_half_open_wire(rig: HeadRig, direction: str) -> None:
    getattr(rig.wire, direction).blocked = True
    with pytest.raises(ReplyTimeout):
        await rig.head.grab()
    getattr(rig.wire, direction).blocked = False
    rig.wire.reset()
    await good(rig.head)


async def test_reset_during_a_grab(rig: HeadRig) -> None:
    rig.server.faults.inject("silent", replies=1)
    grab = asyncio.create_task(rig.head.grab())
    await asyncio.wait({grab}, timeout=0.05)
    rig.wire.reset()
    with pytest.raises(LinkLost):
        await grab
    await good(rig.head)


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("silent", ReplyTimeout), ("error", DeviceFault), ("wrong_id", ProtocolViolation),
     ("malformed", ProtocolViolation)],
)  # fmt: skip
async def test_faults_of_the_large_field_head(fault: str, expected: type[CellError]) -> None:
    async def measure(frames: int) -> tuple[SeenTarget, ...]:
        return (SeenTarget("F1", np.array([0.1, 0.2, 6.0]), 3e-5),)

    server = TargetServer(measure)
    async with ChaosProxy(await server.start()) as wire:
        settings = TargetServerConfig(
            host="127.0.0.1", port=wire.port, reply_timeout_s=0.3, frame_timeout_s=0.0
        )
        async with TargetServerTracker("large_field", settings) as tracker:
            wire.back.split = True
            assert len(await tracker.measure()) == 1
            server.faults.inject(fault, count=1)
            with pytest.raises(expected):
                await tracker.measure()
            async with asyncio.timeout(2.0):
                while True:
                    try:
                        assert len(await tracker.measure()) == 1
                        break
                    except LinkLost:
                        continue
    await server.stop()
