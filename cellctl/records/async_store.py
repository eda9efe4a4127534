"""The run store behind one thread: writes keep their order and never block the event loop."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from cellctl.errors.records import RecordNotWritten
from cellctl.records.store import RunStore

P = ParamSpec("P")
R = TypeVar("R")


class AsyncRunStore:
    """Awaitable access to the run store; faults of the store come back unchanged."""

    def __init__(self, path: Path) -> None:
        """Open the store; raises ``StoreUnavailable``, ``StoreTooNew``."""
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="run-store")
        try:
            self._store: RunStore = self._thread.submit(RunStore, path).result()
        except BaseException:
            self._thread.shutdown()
            raise
        self.fault: RecordNotWritten | None = None
        """The first write that did not reach the disk; the store takes no run after it."""

    async def do(
        self, call: Callable[Concatenate[RunStore, P], R], *args: P.args, **kwargs: P.kwargs
    ) -> R:
        """Call a method of the store: ``await store.do(RunStore.add_alarm, …)``.

        A call that has been handed over is carried out: cancelling the caller does not take back
        the write. Half a record would be worse than one that nobody waits for.
        """

        def work() -> R:
            try:
                return call(self._store, *args, **kwargs)
            except RecordNotWritten as error:
                self.fault = self.fault or error
                raise

        loop = asyncio.get_running_loop()
        return await asyncio.shield(loop.run_in_executor(self._thread, work))

    def close(self) -> None:
        """Finish pending writes and close the store."""
        self._thread.submit(self._store.close).result()
        self._thread.shutdown(wait=True)
