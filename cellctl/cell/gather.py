"""Runs several tasks at once: all or nothing for motion, each by its name for connecting."""

import asyncio
from collections.abc import Awaitable, Coroutine, Mapping, Sequence
from typing import Any, TypeVar

from cellctl import log
from cellctl.errors import CellError
from cellctl.errors.link import ConnectTimeout

_log = log.get(__name__)

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


async def gather_named(attempts: Mapping[str, Awaitable[None]]) -> None:
    """Try to connect all of them; raises one fault that names each device that failed."""
    results = await asyncio.gather(*attempts.values(), return_exceptions=True)
    failed = {
        name: result
        for name, result in zip(attempts, results, strict=True)
        if isinstance(result, BaseException)
    }
    for name, error in failed.items():
        _log.error("device failed to connect", device=name, error=str(error))
    # A defect goes before the faults of devices: its traceback would be lost in the text of a
    # collected fault.
    unexpected = [error for error in failed.values() if not isinstance(error, CellError)]
    if unexpected:
        raise unexpected[0]
    if len(failed) == 1:
        raise next(iter(failed.values()))
    if failed:
        raise ConnectTimeout("; ".join(f"{name}: {error}" for name, error in failed.items()))


async def _leave(tasks: Sequence[asyncio.Task[T]]) -> None:
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def _failures(tasks: Sequence[asyncio.Task[T]]) -> list[BaseException]:
    done = (task for task in tasks if task.done() and not task.cancelled())
    return [error for task in done if (error := task.exception()) is not None]
