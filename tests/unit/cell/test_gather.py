"""Several things at once: nothing goes on behind the back of a failure."""

import asyncio

import pytest

from cellctl.cell.gather import gather_or_cancel
from cellctl.errors.link import LinkLost
from cellctl.errors.robot import MotionRejected, StopFailed


class Worker:
    """Works until it is cancelled, then cleans up, perhaps in vain."""

    def __init__(self, fault: Exception | None = None) -> None:
        self.cleaned = False
        self.begun = asyncio.Event()
        self._fault = fault

    async def work(self) -> int:
        try:
            self.begun.set()
            await asyncio.Event().wait()
        finally:
            await asyncio.sleep(0)
            self.cleaned = True
            if self._fault is not None:
                raise self._fault
        return 0


async def value(number: int) -> int:
    await asyncio.sleep(0)
    return number


async def fail() -> int:
    await asyncio.sleep(0)
    raise MotionRejected("first")


async def test_results_come_in_the_order_given() -> None:
    assert await gather_or_cancel(value(1), value(2)) == [1, 2]


async def test_the_first_failure_ends_the_others_before_it_is_raised() -> None:
    worker = Worker()
    with pytest.raises(MotionRejected, match="first"):
        await gather_or_cancel(worker.work(), fail())
    assert worker.cleaned


async def test_what_fails_while_leaving_is_noted_on_the_first() -> None:
    worker = Worker(StopFailed("aux_2"))
    with pytest.raises(MotionRejected) as caught:
        await gather_or_cancel(worker.work(), fail())
    assert any("F304" in note for note in caught.value.__notes__)


async def cancelled(*workers: Worker) -> asyncio.Task[list[int]]:
    task = asyncio.create_task(gather_or_cancel(*(worker.work() for worker in workers)))
    for worker in workers:
        await worker.begun.wait()
    task.cancel()
    return task


async def test_cancelling_waits_for_all() -> None:
    workers = Worker(), Worker()
    with pytest.raises(asyncio.CancelledError):
        await (await cancelled(*workers))
    assert all(worker.cleaned for worker in workers)


async def test_a_stop_that_failed_is_heard_after_a_cancellation() -> None:
    with pytest.raises(LinkLost):
        await (await cancelled(Worker(), Worker(LinkLost("main"))))
