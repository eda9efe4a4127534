"""The list of active alarms while the disk works."""

import asyncio
from collections.abc import Callable
from typing import cast

from cellctl.errors.line import LineLost
from cellctl.records.async_store import AsyncRunStore
from cellctl.runtime.alarms import Alarms
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
