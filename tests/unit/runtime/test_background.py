"""Background tasks are all waited for, and none of their errors is lost."""

import asyncio

import pytest
from structlog.testing import capture_logs

from cellctl.errors.internal import WorkerDied
from cellctl.runtime.background import Background

# A drain that gives the loop no turn does not end by itself.
pytestmark = pytest.mark.timeout(10)


async def _nothing() -> None:
    """Ends on its first turn."""


async def _failing() -> None:
    raise WorkerDied("a vision worker ended unexpectedly")


async def test_drain_returns_when_all_tasks_have_just_ended() -> None:
    background = Background()
    background.start(_nothing())
    # As a task of its own, drain begins after the work has ended and before its done callback.
    await asyncio.create_task(background.drain())


async def test_drain_waits_for_tasks_that_are_started_meanwhile() -> None:
    background = Background()
    ended = []

    async def second() -> None:
        await asyncio.sleep(0)
        ended.append("second")

    async def first() -> None:
        background.start(second())

    background.start(first())
    await background.drain()
    assert ended == ["second"]


async def test_an_error_is_in_the_log_when_drain_returns() -> None:
    background = Background()
    with capture_logs() as logged:
        background.start(_failing())
        await background.drain()
    assert [(line["log_level"], line["event"]) for line in logged] == [
        ("error", "background work failed")
    ]
