"""Work that can be left: interrupted, cancelled, ended by itself, all at the right moment."""

import asyncio

import pytest

from cellctl.errors.line import LineLostInContact
from cellctl.processes.deck_to_frame.faults import MatingOverforce
from cellctl.runtime.interruption import Interruption

LOST = LineLostInContact("mate")


class Work:
    """Waits until it is told to end, and notes how it was left."""

    def __init__(self) -> None:
        self.begun = asyncio.Event()
        self.may_end = asyncio.Event()
        self.cleaned_up = False
        self.fault: Exception | None = None

    async def __call__(self) -> int:
        self.begun.set()
        try:
            await self.may_end.wait()
        finally:
            await asyncio.sleep(0)
            self.cleaned_up = True
        if self.fault is not None:
            raise self.fault
        return 7


async def test_nothing_runs_that_could_be_left() -> None:
    assert not Interruption().interrupt(LOST)


async def test_work_that_ends_by_itself() -> None:
    interruption, work = Interruption(), Work()
    work.may_end.set()
    assert await interruption.unless(work()) == 7
    assert not interruption.interrupt(LOST), "it is over"


async def test_the_fault_comes_out_after_the_clean_up() -> None:
    interruption, work = Interruption(), Work()
    left = asyncio.create_task(interruption.unless(work()))
    await work.begun.wait()
    assert interruption.interrupt(LOST)
    assert not interruption.interrupt(LOST), "once"
    with pytest.raises(LineLostInContact):
        await left
    assert work.cleaned_up


async def test_work_that_ended_at_the_same_moment_is_left_all_the_same() -> None:
    interruption, work = Interruption(), Work()
    left = asyncio.create_task(interruption.unless(work()))
    await work.begun.wait()
    interruption.interrupt(LOST)
    work.may_end.set()
    with pytest.raises(LineLostInContact):
        await left


async def test_a_fault_of_the_work_at_the_same_moment_counts() -> None:
    interruption = Interruption()

    async def fails() -> None:
        interruption.interrupt(LOST)
        raise MatingOverforce("46 N")

    with pytest.raises(MatingOverforce):
        await interruption.unless(fails())


async def test_cancelling_is_no_interruption() -> None:
    interruption, work = Interruption(), Work()
    left = asyncio.create_task(interruption.unless(work()))
    await work.begun.wait()
    left.cancel()
    with pytest.raises(asyncio.CancelledError):
        await left
    assert work.cleaned_up
