"""Work that nobody waits for."""

import asyncio
from collections.abc import Coroutine


class BackgroundTasks:
    """Keeps tasks from being forgotten before they end. What they raise is theirs to make known."""

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[None]] = set()

    def start(self, job: Coroutine[None, None, None]) -> "asyncio.Task[None]":
        """Run it."""
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
        if not task.cancelled():
            task.exception()
