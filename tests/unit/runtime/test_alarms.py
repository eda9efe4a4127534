"""The list of active alarms while the disk works."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import cast

from cellctl.errors.line import LineLost
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.alarms import KEPT, Alarms
from cellctl.runtime.background import Background


class SlowStore:
    """Takes every call, once the test lets the disk go on."""

    def __init__(self) -> None:
        self.goes_on = asyncio.Event()
        self.calls: list[str] = []

    async def do(self, call: Callable[..., object], *_args: object) -> None:
        self.calls.append(call.__name__)
        await self.goes_on.wait()


async def test_an_alarm_that_comes_while_its_number_is_acknowledged_stays_active() -> None:
    store, background = SlowStore(), Background()
    alarms = Alarms(cast(AsyncRunStore, store), background)
    alarms.add(LineLost("the first"), None)
    acknowledging = asyncio.create_task(alarms.acknowledge(LineLost.number, "somebody"))
    await asyncio.sleep(0)
    alarms.add(LineLost("the second"), None)
    assert len(alarms.active) == 1
    store.goes_on.set()
    assert await acknowledging
    await background.drain()
    (left,) = alarms.active
    assert "the second" in left.text
    assert await alarms.acknowledge(LineLost.number, "somebody")
    assert not alarms.numbers


async def test_only_those_that_were_seen_are_acknowledged(tmp_path: Path) -> None:
    store, background = AsyncRunStore(tmp_path), Background()
    alarms = Alarms(store, background)
    for facts in ("the first", "the second", "the third"):
        alarms.add(LineLost(facts), None)
    await background.drain()
    (shown,) = alarms.active
    assert shown.times == 3
    assert shown.newest is not None
    assert shown.newest >= shown.since
    assert await alarms.acknowledge(LineLost.number, "somebody", seen=2)
    (left,) = alarms.active
    assert (left.times, left.newest) == (1, None)
    assert "the third" in left.text
    assert [("the third" in one.text) for one in await store.do(RunStore.active_alarms)] == [True]
    again = Alarms(store, background)
    await again.open()
    assert [one.text for one in again.active] == [left.text]
    assert await alarms.acknowledge(LineLost.number, "somebody", seen=7)
    assert not alarms.numbers
    store.close()


async def test_a_chattering_alarm_takes_no_memory_and_loses_no_count() -> None:
    store, background = SlowStore(), Background()
    store.goes_on.set()
    alarms = Alarms(cast(AsyncRunStore, store), background)
    for number in range(3 * KEPT):
        alarms.add(LineLost(f"time {number}"), None)
    assert await alarms.acknowledge(LineLost.number, "somebody", seen=5)
    (left,) = alarms.active
    assert left.times == 3 * KEPT - 5
    assert f"time {2 * KEPT}" in left.text, "the oldest one that is remembered"
    assert await alarms.acknowledge(LineLost.number, "somebody", seen=left.times)
    assert not alarms.numbers
    await background.drain()
