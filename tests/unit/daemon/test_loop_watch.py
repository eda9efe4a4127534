"""A loop that was held is told with what it was held by."""

import asyncio
import hashlib
import time
from collections.abc import Callable

import pytest
from structlog.testing import capture_logs
from structlog.typing import EventDict

from cellctl.daemon.loop_watch import watch_loop


def _computes() -> None:
    end_s = time.thread_time() + 0.2
    while time.thread_time() < end_s:
        hashlib.sha256(b"0" * 1000)


def _waits() -> None:
    time.sleep(0.2)


async def _held_by(work: Callable[[], None]) -> EventDict:
    turns: list[float] = []
    with capture_logs() as lines:
        watch = asyncio.create_task(watch_loop(turns.append, 0.001, 0.15))
        await asyncio.sleep(0)  # the watch begins its turn
        work()
        await asyncio.sleep(0.01)  # its turn ends before this: it was due while the work went on
        watch.cancel()
    (told,) = (line for line in lines if line["event"] == "event loop held")
    assert max(turns) == pytest.approx(told["seconds"] - 0.001, abs=0.002)
    return told


async def test_a_loop_that_computes() -> None:
    told = await _held_by(_computes)
    assert told["seconds"] >= 0.2
    assert told["computed_s"] >= 0.15


async def test_a_loop_that_waits() -> None:
    told = await _held_by(_waits)
    assert told["seconds"] >= 0.2
    assert told["computed_s"] < 0.15


async def test_a_loop_that_turns_is_not_mentioned() -> None:
    with capture_logs() as lines:
        watch = asyncio.create_task(watch_loop(lambda _late_s: None, 0.001, 60.0))
        await asyncio.sleep(0.05)
        watch.cancel()
    assert lines == []


@pytest.mark.parametrize("work", [_computes, _waits])
async def test_it_goes_on_watching(work: Callable[[], None]) -> None:
    for _ in range(2):
        assert (await _held_by(work))["seconds"] >= 0.2
