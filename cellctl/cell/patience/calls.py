"""How long the core waits for a call of a driver, and how it leaves one that hangs."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from cellctl import log
from cellctl.errors.link import ReplyTimeout

_log = log.get(__name__)

PATIENCE_S = 180.0
"""Longest call of a driver. Drivers have time-outs of their own, some of a minute; this one is for
a driver that hangs, so it only has to be longer than all of those."""
END_S = 6.0
"""A driver that is cancelled may stop its arm first, which takes it a few seconds. Less than what a
cancelled job is given as a whole."""

T = TypeVar("T")


async def answer_within(
    call: Coroutine[Any, Any, T], whose: str, patience_s: float = PATIENCE_S
) -> T:
    """What a call of a driver returns or raises; ``ReplyTimeout`` when it does not come back."""
    task = asyncio.create_task(call)
    await done_or_left(task, {task}, patience_s)
    if not task.done():
        await leave(task)
        raise ReplyTimeout(f"{whose}: its driver has not come back in {patience_s:g} s")
    return task.result()


async def done_or_left(
    call: asyncio.Task[T], events: set[asyncio.Task[Any]], patience_s: float | None = None
) -> None:
    """Wait for one of the events. A caller that is cancelled meanwhile leaves the call first.

    A fault that the call ends with then is raised instead: an arm that did not stop must be heard
    of.
    """
    try:
        await asyncio.wait(events, timeout=patience_s, return_when=asyncio.FIRST_COMPLETED)
    except asyncio.CancelledError:
        await leave(call)
        if call.done() and not call.cancelled() and (fault := call.exception()) is not None:
            raise fault from None
        raise


async def leave(call: asyncio.Task[Any], end_s: float = END_S) -> None:
    """Cancel a call and give it time to end; one that does not is left to itself, and logged."""
    call.cancel()
    await asyncio.wait({call}, timeout=end_s)
    if not call.done():
        # Whoever waited for it would hang with it. The stop of all motion has bounds of its own.
        _log.error("a driver does not end a cancelled call", call=repr(call.get_coro()))
