"""The real guard process between the fake box and a scripted robot on its GRD channel."""

import asyncio
import contextlib
import random
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import GuardLimits, GuardSettings
from cellctl.guard.report import GuardTrip
from fakes.wire.sri.box import SriBox
from tests.rigs.waiting import until
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.siasun_peer import Peer

NOTHING = GravityCompensation(np.zeros((6, 3)), np.zeros(6), "affine24")
PATIENT = GuardLimits(raw=(20.0,) * 6, stale_s=0.3, flange_age_s=0.5)
"""Long enough for a test machine that is busy; each test shortens what it is about."""
SETTINGS = GuardSettings(ring_slots=16_384)


@dataclass
class Robot:
    """Reports every 20 ms, latches on ABORT, and notes when it hears what."""

    peer: Peer
    latched: bool = False
    deaf: int = 0
    """Number of stop requests that are ignored."""
    mute: bool = False
    beats_s: list[float] = field(default_factory=list)
    stops_s: list[float] = field(default_factory=list)
    lost: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self) -> None:
        async with asyncio.TaskGroup() as tasks:
            reporter = tasks.create_task(self._report())
            await self._listen()
            reporter.cancel()

    async def _report(self) -> None:
        while True:
            if not self.mute:
                with contextlib.suppress(ConnectionError):
                    self.peer.stat(f"REM,0,1,0,{int(self.latched)},0,100")
            await asyncio.sleep(0.02)

    async def _listen(self) -> None:
        try:
            while record := await self.peer.reader.readline():
                if record.startswith(b"BEAT"):
                    self.beats_s.append(time.monotonic())
                elif record.startswith(b"ABORT"):
                    self.stops_s.append(time.monotonic())
                    self.latched = self.latched or len(self.stops_s) > self.deaf
        except ConnectionError:
            pass  # how a killed guard looks from here
        self.lost.set()

    async def stopped(self, count: int = 1) -> None:
        """Wait until so many stop requests have come, at most two seconds."""
        await until(lambda: len(self.stops_s) >= count)


@dataclass
class Rig:
    """All that a test may want to touch."""

    box: SriBox
    client: GuardClient
    robot: Robot
    force: list[float]
    """Fx … Mz that the box measures, without its noise."""


async def tripped(client: GuardClient, timeout_s: float = 2.0) -> GuardTrip:
    """The trip that is latched or comes; ``TimeoutError`` without one."""
    await until(lambda: client.trip is not None, timeout_s)
    assert client.trip is not None
    return client.trip


def noisy(force: list[float]) -> list[float]:
    return [value + random.gauss(0.0, 0.2) for value in force]


@asynccontextmanager
async def rig(settings: GuardSettings = SETTINGS, **sensor: Any) -> AsyncIterator[Rig]:
    """A started guard with a robot on its channel and a load of nothing."""
    force = [0.0] * 6
    box = SriBox(lambda time_s: noisy(force))
    values = {
        "transport": "tcp",
        "host": "127.0.0.1",
        "port": await box.start_tcp(),
        "rate_hz": 500,
    }
    (port,) = free_ports(1)
    client = GuardClient(
        "sri",
        values | sensor,
        "siasun-sjl",
        {"robot_name": "SR500A", "guard_port": port},
        settings,
    )
    starting = asyncio.create_task(client.start())
    peer = await _peer(port, starting)
    robot = Robot(peer)
    running = asyncio.create_task(robot.run())
    try:
        await starting
        await client.set_gravity_compensation(NOTHING)
        await until(lambda: client.health().flange_age_s < 1.0)
        yield Rig(box, client, robot, force)
    finally:
        await client.stop()
        peer.writer.close()
        await asyncio.gather(running, return_exceptions=True)
        await box.stop()


async def _peer(port: int, starting: "asyncio.Task[None]") -> Peer:
    """Connect once the guard listens: it needs a second to start."""
    async with asyncio.timeout(10):
        while True:
            if starting.done():
                starting.result()
            try:
                reader, writer = await asyncio.open_connection("127.0.0.1", port)
            except ConnectionRefusedError:
                await asyncio.sleep(0.01)
                continue
            peer = Peer(reader, writer)
            await peer.hello("GRD")
            return peer
