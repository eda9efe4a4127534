"""Waiting for what another task, thread or process does: it gives no event, so one looks again."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar

T = TypeVar("T")

_LOOK_S = 0.002
"""Pause between two looks: no test that waits is longer for it."""


async def until(condition: Callable[[], object], within_s: float = 2.0) -> None:
    """Wait until a condition holds; ``TimeoutError`` if it does not."""
    async with asyncio.timeout(within_s):
        while not condition():  # noqa: ASYNC110 - what is waited for lies in other processes
            await asyncio.sleep(_LOOK_S)


async def until_answer(
    ask: Callable[[], Awaitable[T]], fits: Callable[[T], bool], within_s: float = 3.0
) -> T:
    """Ask until an answer fits, and return it; ``TimeoutError`` if none does."""
    async with asyncio.timeout(within_s):
        while not fits(answer := await ask()):
            pass
    return answer


def until_blocking(
    ask: Callable[[], T],
    fits: Callable[[T], bool] = bool,
    *,
    within_s: float = 10.0,
    look_s: float = 0.01,
) -> T:
    """The same without an event loop; fails if no answer fits."""
    end_s = time.monotonic() + within_s
    while not fits(answer := ask()):
        assert time.monotonic() < end_s, f"still {answer!r} after {within_s:g} s"
        time.sleep(look_s)
    return answer
