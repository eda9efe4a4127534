"""Asks the disk of the run store for a sign of life while a run is open."""

import asyncio

from cellctl.errors import CellError
from cellctl.errors.records import RecordSilent
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.files.disk_space import require_writable
from cellctl.records.store import RunStore
from cellctl.runtime.unit import UnitController

ANSWER_TIMEOUT_S = 10.0
"""A disk that is busy with raw images answers within a second or two."""


class DiskWatch:
    """Steps write when they begin and end. Between them an arm may move for a minute, without a
    record when the disk has filled up or hangs meanwhile."""

    def __init__(self, store: AsyncRunStore, unit: UnitController) -> None:
        self._store = store
        self._unit = unit
        self._told: int | None = None
        """The run whose disk was found silent: said once."""

    async def look(self, timeout_s: float = ANSWER_TIMEOUT_S) -> None:
        """Write once, if a run is open; a fault of the disk goes to the machine."""
        run = self._unit.jobs.run_number
        if run is None or run == self._told:
            return
        try:
            async with asyncio.timeout(timeout_s):
                await self._store.do(_require_writable)
        except TimeoutError:
            await self._fail(run, RecordSilent(f"run {run}: no answer within {timeout_s:g} s"))
        except CellError as fault:
            await self._fail(run, fault)

    async def _fail(self, run: int, fault: CellError) -> None:
        # A disk that is full stays full, and one alarm a run is enough to read.
        self._told = run
        await self._unit.machine.fail(fault)


def _require_writable(store: RunStore) -> None:
    require_writable(store.path)
