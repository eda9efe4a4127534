"""Tasks that no caller awaits, such as writing an alarm: their failures go to the log."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from cellctl import log

_log = log.get(__name__)


class Background:
    """Holds a reference to each of its tasks until that task has ended."""

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[object]] = set()

    def start(self, work: Coroutine[Any, Any, object]) -> None:
        """Start ``work`` as a task; its errors are logged."""
        task = asyncio.create_task(work)
        # The event loop holds only weak references to tasks: without this one the task could be
        # collected before it has ended.
        self._tasks.add(task)
        task.add_done_callback(self._ended)

    async def drain(self) -> None:
        """Wait until all tasks have ended, also those that are started meanwhile."""
        while self._tasks:
            await asyncio.gather(*self._tasks, return_exceptions=True)
            # A task leaves the set in its done callback, and callbacks run on the loop's next turn.
            # Since Python 3.12 gather over tasks that have all ended returns without such a turn.
            await asyncio.sleep(0)

    def _ended(self, task: asyncio.Task[object]) -> None:
        self._tasks.discard(task)
        error = None if task.cancelled() else task.exception()
        if error is not None:
            _log.error("background work failed", fault=str(error))
