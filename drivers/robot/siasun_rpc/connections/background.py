"""Work that nobody waits for."""

import asyncio
import logging
from collections.abc import Coroutine

from cellctl.errors import CellError

_log = logging.getLogger(__name__)


class BackgroundTasks:
    """Holds tasks until they end, because the event loop itself only holds weak references to them.

    What faults a task raises it must make known itself.
    """

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[None]] = set()

    def start(self, job: Coroutine[None, None, None]) -> "asyncio.Task[None]":
        """Run a coroutine as a task."""
        task = asyncio.create_task(job)
        self._tasks.add(task)
        task.add_done_callback(self._forget)
        return task

    def cancel(self) -> None:
        """End all, except the one that asks for it."""
        for task in self._tasks - {asyncio.current_task()}:
            task.cancel()

    def _forget(self, task: "asyncio.Task[None]") -> None:
        self._tasks.discard(task)
        # Taken, so that the event loop does not report a fault that is known as one nobody saw. A
        # defect is known to nobody.
        error = None if task.cancelled() else task.exception()
        if error is not None and not isinstance(error, CellError):
            _log.error("background work of a robot's link failed", exc_info=error)
