"""The run store in a thread of its own: writes keep their order and do not block the event loop."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from cellctl import log
from cellctl.clock import now_s
from cellctl.errors.records.store import RecordNotWritten, RecordsError, StoreLocked
from cellctl.records.database.sessions import LOCK_WAIT_S
from cellctl.records.files.disk_space import require_space
from cellctl.records.files.raw_images import (
    MEDIA_TYPE,
    GreyImage,
    coding_thread,
    encode_and_put,
)
from cellctl.records.files.unwritten_end import UnwrittenEnd
from cellctl.records.store import RunStore

_log = log.get(__name__)

IMAGES_TIMEOUT_S = 5.0
"""How long the closing of a run waits for its images."""
P = ParamSpec("P")
R = TypeVar("R")


class AsyncRunStore:
    """Awaitable access to the run store; faults of the store come back unchanged."""

    def __init__(self, path: Path, *, lock_wait_s: float = LOCK_WAIT_S) -> None:
        """Open the store; raises ``StoreUnavailable``, ``StoreTooNew``."""
        # One thread: SQLite takes one writer, and records must reach the disk in the order in which
        # they were given.
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="run-store")
        try:
            self._store: RunStore = self._thread.submit(
                RunStore, path, lock_wait_s=lock_wait_s
            ).result()
        except BaseException:
            self._thread.shutdown()
            raise
        self.path = path.absolute()
        self._images = coding_thread()
        self._keeping: set[asyncio.Task[None]] = set()
        self.fault: RecordNotWritten | None = None
        """The first write that did not reach the disk; the store takes no run after it."""
        self.scarcity: RecordsError | None = None
        """Why the disk had no room for another run when it was last looked at."""
        self._unkept: dict[int, UnwrittenEnd] = {}
        """Ends of runs that reached neither the database nor a file beside it, by run."""

    @property
    def refusal(self) -> RecordsError | None:
        """Why the store takes no run now."""
        return self.fault or self.scarcity

    async def look_for_room(self) -> None:
        """See whether the disk has room for another run; ``scarcity`` says why not."""
        try:
            await self.do(_require_space)
        except RecordsError as error:
            self.scarcity = error
        else:
            self.scarcity = None

    async def keep_end(self, run: int, end: UnwrittenEnd) -> None:
        """Keep how a run ended that could not be closed, as soon as the disk takes it."""
        self._unkept[run] = end
        await self.keep_ends()

    async def keep_ends(self) -> None:
        """Try again what ``keep_end`` could not keep; costs nothing when there is none."""
        if self._unkept:
            await asyncio.get_running_loop().run_in_executor(self._thread, self._keep_ends)

    def _keep_ends(self) -> None:
        for run, end in tuple(self._unkept.items()):
            try:
                self._store.keep_end(run, end)
            except RecordNotWritten as error:
                _log.error("end of a run not kept yet", run=run, end=end.fault, fault=str(error))
            else:
                del self._unkept[run]

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

    async def insist(
        self,
        patience_s: float,
        call: Callable[Concatenate[RunStore, P], R],
        *args: P.args,
        **kwargs: P.kwargs,
    ) -> R:
        """As ``do``, and again while another program keeps the store locked, for so long.

        Raises ``StoreLocked`` after that. For what nothing else can take the place of.
        """
        give_up_s = now_s() + patience_s
        while True:
            try:
                return await self.do(call, *args, **kwargs)
            except StoreLocked as fault:
                # Each try has waited for the lock itself, so there is no need of a pause.
                if now_s() >= give_up_s:
                    raise
                _log.warning("run store is locked", call=call.__name__, fault=str(fault))

    def keep_image(self, run: int, name: str, image: GreyImage) -> None:
        """Keep an image, shape (height, width), as a file of a run, whenever there is time.

        Returns at once: a run neither waits for its images nor ends because one was not kept.
        """
        task = asyncio.create_task(self._keep_image(run, name, image))
        # The event loop holds only weak references to tasks.
        self._keeping.add(task)
        task.add_done_callback(self._ended)

    async def images_kept(self, timeout_s: float = IMAGES_TIMEOUT_S) -> None:
        """Wait for the images that were given until now; later ones find their run closed."""
        if self._keeping:
            _, late = await asyncio.wait(set(self._keeping), timeout=timeout_s)
            if late:
                _log.error("raw images are late", images=len(late), timeout_s=timeout_s)

    async def _keep_image(self, run: int, name: str, image: GreyImage) -> None:
        loop = asyncio.get_running_loop()
        files = self._store.artefacts
        try:
            data = await loop.run_in_executor(self._images, encode_and_put, image, files)
            await self.do(RunStore.add_artefact, run, name, data, MEDIA_TYPE)
        # A raw image serves later questions. A run that made a good part must not end because one
        # is missing.
        except RecordsError as error:
            _log.error("raw image not kept", run=run, image=name, fault=str(error))

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._keeping.discard(task)
        # Nobody awaits it, so that an error which no fault describes would be seen by nobody.
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("raw image not kept", exc_info=error)

    def close(self) -> None:
        """Finish pending writes and close the store."""
        self._images.shutdown(wait=True)
        self._thread.submit(self._keep_ends).result()
        self._thread.submit(self._store.close).result()
        self._thread.shutdown(wait=True)


def _require_space(store: RunStore) -> None:
    require_space(store.path)
