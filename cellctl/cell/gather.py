"""Runs several tasks at once; when one of them fails, all others have ended before it is told."""

import asyncio
from collections.abc import Coroutine, Sequence
from typing import Any, TypeVar

from cellctl.errors import CellError

T = TypeVar("T")


async def gather_or_cancel(*work: Coroutine[Any, Any, T]) -> list[T]:
    """Results in the order given, of one or more; the first failure cancels the others.

    Returns, or raises that failure, only after every one of them has ended, so a robot move among
    them has stopped its robot. What goes wrong while the others are left is noted on the first
    failure; after a cancellation it is raised itself: a robot that did not stop must be heard of.
    """
    tasks = [asyncio.create_task(one) for one in work]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION)
    except asyncio.CancelledError:
        await _leave(tasks)
        for fault in _failures(tasks):
            raise fault from None
        raise
    # Noted before the others are left: they then fail by being stopped, and that is a consequence.
    first = _failures(tasks)
    await _leave(tasks)
    if not first:
        return [task.result() for task in tasks]
    for second in _failures(tasks):
        if second is not first[0] and isinstance(second, CellError):
            first[0].add_note(f"beside it: {second}")
    raise first[0]


async def _leave(tasks: Sequence[asyncio.Task[T]]) -> None:
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def _failures(tasks: Sequence[asyncio.Task[T]]) -> list[BaseException]:
    done = (task for task in tasks if task.done() and not task.cancelled())
    return [error for task in done if (error := task.exception()) is not None]
