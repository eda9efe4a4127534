"""A call of a driver comes back, or ends in a fault, or is left to itself: nobody waits on."""

import asyncio
from collections.abc import AsyncIterator

import pytest
from structlog.testing import capture_logs

from cellctl.cell.patience.calls import answer_within, leave
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.errors.robot import StopFailed


class Driver:
    """Hangs in its calls; says how they were left."""

    def __init__(self) -> None:
        self.asked, self.lets_go = asyncio.Event(), asyncio.Event()
        self.cancelled = 0
        self.stubborn = False
        self.stop_fails = False

    async def call(self) -> str:
        self.asked.set()
        while not self.lets_go.is_set():
            try:
                await self.lets_go.wait()
            except asyncio.CancelledError:
                self.cancelled += 1
                if self.stop_fails:
                    raise StopFailed("main still moves") from None
                if not self.stubborn:
                    raise
        return "answer"


@pytest.fixture
async def driver() -> AsyncIterator[Driver]:
    driver = Driver()
    yield driver
    driver.lets_go.set()


async def test_an_answer_passes(driver: Driver) -> None:
    driver.lets_go.set()
    assert await answer_within(driver.call(), "head") == "answer"


async def test_a_fault_passes() -> None:
    async def fails() -> None:
        raise LinkLost("cut")

    with pytest.raises(LinkLost, match="cut"):
        await answer_within(fails(), "head")


async def test_a_call_that_hangs_is_left(driver: Driver) -> None:
    with pytest.raises(ReplyTimeout, match=r"head: its driver has not come back in 0\.01 s"):
        await answer_within(driver.call(), "head", 0.01)
    assert driver.cancelled == 1


async def test_a_caller_that_is_cancelled_cancels_the_call(driver: Driver) -> None:
    caller = asyncio.create_task(answer_within(driver.call(), "head"))
    await driver.asked.wait()
    caller.cancel()
    with pytest.raises(asyncio.CancelledError):
        await caller
    assert driver.cancelled == 1


async def test_an_arm_that_does_not_stop_is_heard_of(driver: Driver) -> None:
    driver.stop_fails = True
    caller = asyncio.create_task(answer_within(driver.call(), "main"))
    await driver.asked.wait()
    caller.cancel()
    with pytest.raises(StopFailed, match="main still moves"):
        await caller


async def test_nobody_waits_for_a_driver_that_does_not_end(driver: Driver) -> None:
    driver.stubborn = True
    task = asyncio.create_task(driver.call())
    await driver.asked.wait()
    with capture_logs() as lines:
        await leave(task, end_s=0.01)
    assert not task.done()
    assert [line["event"] for line in lines] == ["a driver does not end a cancelled call"]
    driver.lets_go.set()
    assert await task == "answer"
