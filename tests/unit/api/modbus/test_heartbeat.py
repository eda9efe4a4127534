"""The watch over the line's counter."""

import asyncio
import time
from collections.abc import AsyncIterator

import pytest

from cellctl.api.modbus.heartbeat import HeartbeatWatch


class Rig:
    def __init__(self) -> None:
        self.lost = asyncio.Event()
        self.watch = HeartbeatWatch(0.1, self.lost.set)


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    rig = Rig()
    yield rig
    rig.watch.stop()


async def test_missing_is_not_lost(rig: Rig) -> None:
    assert not rig.watch.alive
    assert not rig.watch.lost


async def test_a_value_that_never_changes_is_no_heartbeat(rig: Rig) -> None:
    assert not rig.watch.seen(0)
    assert not rig.watch.alive


async def test_its_age_is_that_of_its_last_change(rig: Rig) -> None:
    assert rig.watch.age_s is None
    rig.watch.seen(5)
    await asyncio.sleep(0.02)
    rig.watch.seen(5)
    assert rig.watch.age_s is not None
    assert rig.watch.age_s >= 0.02
    await asyncio.wait_for(rig.lost.wait(), 2)
    assert rig.watch.age_s >= 0.1, "a lost one goes on to age"


async def test_lost_once_and_back_on_change(rig: Rig) -> None:
    assert rig.watch.seen(5)
    assert not rig.watch.seen(6)
    await asyncio.wait_for(rig.lost.wait(), 2)
    assert rig.watch.lost
    assert not rig.watch.alive
    assert not rig.watch.seen(6)
    assert rig.watch.lost
    assert rig.watch.seen(7)
    assert not rig.watch.lost


async def test_a_loop_that_was_held_up_does_not_blame_the_line(rig: Rig) -> None:
    loop = asyncio.get_running_loop()
    rig.watch.seen(1)
    loop.call_soon(time.sleep, 0.4)  # a blocking call somewhere in the daemon
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    rig.watch.seen(2)  # the beat that waited in the socket
    assert rig.watch.alive
    assert not rig.lost.is_set()
    await asyncio.wait_for(rig.lost.wait(), 2)  # and then it really stops


async def test_a_loop_that_is_always_late_finds_a_dead_line_all_the_same(rig: Rig) -> None:
    rig.watch.seen(1)
    turns = 0
    while not rig.lost.is_set() and turns < 20:
        turns += 1
        # Whatever in the daemon holds the loop up, again and again.
        asyncio.get_running_loop().call_soon(time.sleep, 0.18)
        await asyncio.sleep(0)
    # The time-out of 0.1 s and the grace of 0.25 s take two turns each, and one more at each end.
    assert rig.watch.lost
    assert turns <= 6


async def test_a_line_that_died_while_the_loop_was_held_up_is_lost_after_all(rig: Rig) -> None:
    rig.watch.seen(1)
    asyncio.get_running_loop().call_soon(time.sleep, 0.4)
    await asyncio.wait_for(rig.lost.wait(), 2)
    assert rig.watch.lost
