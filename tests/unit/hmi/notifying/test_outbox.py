"""Told in order, tried again, dropped at last; nothing of it delays who has something to tell."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from typing import Any

from cellctl.hmi.notifying.outbox import Outbox, Retries
from cellctl.hmi.notifying.senders import NotTold

SOON = Retries(first_wait_s=0.001, longest_wait_s=0.002)


class Scripted:
    """Fails as often as is said, then delivers."""

    name = "scripted"

    def __init__(self, failures: int) -> None:
        self.failures = failures
        self.told: list[int] = []
        self.tried = 0
        self._delivered = asyncio.Event()

    async def send(self, message: Mapping[str, Any]) -> None:
        self.tried += 1
        if self.failures:
            self.failures -= 1
            raise NotTold("not now")
        self.told.append(message["n"])
        self._delivered.set()

    async def until_told(self, count: int) -> None:
        async with asyncio.timeout(30.0):
            while len(self.told) < count:
                self._delivered.clear()
                await self._delivered.wait()


@asynccontextmanager
async def running(outbox: Outbox) -> AsyncIterator[None]:
    task = asyncio.create_task(outbox.run())
    try:
        yield
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


def numbered(n: int) -> dict[str, Any]:
    return {"event": "alarm", "n": n}


async def test_in_order_whatever_fails_first() -> None:
    sender = Scripted(failures=3)
    outbox = Outbox(sender, SOON)
    async with running(outbox):
        for n in range(5):
            outbox.put(numbered(n))
        await sender.until_told(5)
        outbox.put(numbered(5))
        await sender.until_told(6)
    assert sender.told == [0, 1, 2, 3, 4, 5]
    assert sender.tried == 9
    assert outbox.dropped == 0


async def test_old_news_is_given_up() -> None:
    sender = Scripted(failures=1)
    outbox = Outbox(sender, Retries(first_wait_s=0.001, keep_s=0.0))
    async with running(outbox):
        outbox.put(numbered(0))
        outbox.put(numbered(1))
        await sender.until_told(1)
    assert sender.told == [1]
    assert outbox.dropped == 1


async def test_of_too_many_the_oldest_go() -> None:
    sender = Scripted(failures=0)
    outbox = Outbox(sender, Retries(most=3))
    for n in range(5):
        outbox.put(numbered(n))
    async with running(outbox):
        await sender.until_told(3)
    assert sender.told == [2, 3, 4]
    assert outbox.dropped == 2


async def test_one_that_is_pushed_out_while_it_is_sent_is_not_mistaken_for_the_next() -> None:
    release = asyncio.Event()

    class Slow(Scripted):
        async def send(self, message: Mapping[str, Any]) -> None:
            if message["n"] == 0:
                await release.wait()
            await super().send(message)

    sender = Slow(failures=0)
    outbox = Outbox(sender, Retries(most=2))
    async with running(outbox):
        for n in range(4):
            outbox.put(numbered(n))
            await asyncio.sleep(0)
        release.set()
        await sender.until_told(3)
    assert sender.told[-2:] == [2, 3]
