"""A guard process that is begun before it is needed."""

import os
import signal
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from cellctl.guard.client import GuardClient
from fakes.wire.sri.box import SriBox
from tests.rigs.waiting import until
from tests.rigs.whole_cell.guard_rig import SETTINGS


@dataclass
class Sensor:
    """A box, and how often it was asked for a sample: only whoever has opened it asks."""

    asked: list[float] = field(default_factory=list)

    def sample(self, time_s: float) -> list[float]:
        self.asked.append(time_s)
        return [0.0] * 6


@dataclass
class Watched:
    """A sensor and its guard, which is not started."""

    sensor: Sensor
    client: GuardClient


@pytest.fixture
async def watched() -> AsyncIterator[list[Watched]]:
    sensors = [Sensor(), Sensor()]
    boxes = [SriBox(sensor.sample) for sensor in sensors]
    clients = []
    for box in boxes:
        address = {"transport": "tcp", "host": "127.0.0.1", "port": await box.start_tcp()}
        clients.append(GuardClient("sri", address | {"rate_hz": 500}, None, None, SETTINGS))
    yield [Watched(*each) for each in zip(sensors, clients, strict=True)]
    for client in clients:
        await client.stop()
    for box in boxes:
        await box.stop()


def guards() -> list[int]:
    """Numbers of the guard processes of this one."""
    found = []
    for task in Path("/proc/self/task").iterdir():
        for number in map(int, (task / "children").read_text("ascii").split()):
            if b"cellctl.guard.watch.main" in Path(f"/proc/{number}/cmdline").read_bytes():
                found.append(number)
    return found


async def loaded(watched: Watched) -> int:
    watched.client.load()
    await until(lambda: len(guards()) == 1)
    return guards()[0]


async def test_it_opens_nothing_and_is_no_guard_before_its_start(watched: list[Watched]) -> None:
    ahead, other = watched
    number = await loaded(ahead)
    # One that was begun after it has loaded and opened its sensor meanwhile.
    await other.client.start()
    await until(lambda: other.sensor.asked)
    assert number in guards()
    assert not ahead.sensor.asked
    assert not ahead.client.running
    assert ahead.client.newest() is None
    assert not ahead.client.health().alive


async def test_the_start_uses_it(watched: list[Watched]) -> None:
    one, _ = watched
    number = await loaded(one)
    one.client.load()
    await one.client.start()
    assert [one.client.pid] == guards() == [number]
    await until(lambda: one.client.newest() is not None)


async def test_its_death_is_no_trip_and_another_takes_its_place(watched: list[Watched]) -> None:
    one, _ = watched
    number = await loaded(one)
    os.kill(number, signal.SIGKILL)
    # What is left of a process goes when the one that has started it notices its end.
    await until(lambda: not Path(f"/proc/{number}").exists())
    await one.client.start()
    assert one.client.trip is None
    assert one.client.pid not in {0, number}


async def test_the_end_of_the_client_ends_it_without_a_word(
    watched: list[Watched], capfd: pytest.CaptureFixture[str]
) -> None:
    one, _ = watched
    await loaded(one)
    await one.client.stop()
    assert guards() == []
    assert capfd.readouterr().err == ""
