"""Asks the disk of the run store for a sign of life in a run, and for room between runs."""

import asyncio

from cellctl.errors import CellError
from cellctl.errors.records.store import DiskNearlyFull, RecordSilent
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.files.disk_space import require_writable
from cellctl.records.store import RunStore
from cellctl.runtime.unit import AT_REST, UnitController

ANSWER_TIMEOUT_S = 10.0
"""A disk that is busy with raw images answers within a second or two."""


class DiskWatch:
    """Steps write when they begin and end. Between them an arm may move for a minute, without a
    record when the disk has filled up or hangs meanwhile. And whoever puts a part in place is to
    know before Start that the disk has no room for its record."""

    def __init__(self, store: AsyncRunStore, unit: UnitController) -> None:
        self._store = store
        self._unit = unit
        self._told: int | None = None
        """The run whose disk was found silent: said once."""
        self._scarce = False
        self._asking: asyncio.Task[None] | None = None

    async def look(self, timeout_s: float = ANSWER_TIMEOUT_S) -> None:
        """Write once if a run is open, else ask for room; a fault goes to the machine."""
        run = self._unit.jobs.run_number
        if run is None:
            # Not while an arm lifts off or drives home: what is asked here serves the next Start.
            if self._unit.machine.state in AT_REST:
                await self._look_for_room(timeout_s)
            return
        if run == self._told:
            return
        try:
            async with asyncio.timeout(timeout_s):
                await self._store.do(_require_writable)
        except TimeoutError:
            await self._fail(run, RecordSilent(f"run {run}: no answer within {timeout_s:g} s"))
        except CellError as fault:
            await self._fail(run, fault)

    async def _look_for_room(self, timeout_s: float) -> None:
        # A disk that hangs is told by the command that waits for it. Here it is asked once, and not
        # again before it has answered: questions would pile up before the writes of that command.
        self._asking = self._asking or asyncio.create_task(self._ask())
        done, _ = await asyncio.wait({self._asking}, timeout=timeout_s)
        if not done:
            return
        self._asking.result()
        self._asking = None
        known, fault = self._scarce, self._store.scarcity
        self._scarce = fault is not None
        # Any other fault of the disk is the business of the command that meets it.
        if isinstance(fault, DiskNearlyFull) and not known:
            await self._unit.machine.fail(fault)

    async def _ask(self) -> None:
        await self._store.look_for_room()
        # A run may have ended while the disk was full. Its end is written as soon as there is room,
        # and not only when the daemon is started again.
        await self._store.keep_ends()

    async def _fail(self, run: int, fault: CellError) -> None:
        # A disk that is full stays full, and one alarm a run is enough to read.
        self._told = run
        await self._unit.machine.fail(fault)


def _require_writable(store: RunStore) -> None:
    require_writable(store.path)
