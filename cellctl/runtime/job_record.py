"""The record of one job with contact: opened before anything moves, closed whatever happens."""

import asyncio
from collections.abc import Sequence

from cellctl import log
from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.cell.devices import Cell
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.records import RecordSilent
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.runtime.provenance import provenance
from cellctl.version import software

_log = log.get(__name__)

OPEN_TIMEOUT_S = 30.0
"""For the disk to take the row and the files of a run; nothing has moved yet."""


class JobRecord:
    """At most one run row."""

    def __init__(self, cell: Cell, store: AsyncRunStore, command: UnitCommand) -> None:
        self.store = store
        self.number = 0
        """Of the run; 0 until it is open."""
        self._cell = cell
        self._command = command
        self._opening: asyncio.Task[None] | None = None

    async def open(
        self,
        recipe: Recipe,
        mode: str,
        stored: Sequence[StoredCalibration],
    ) -> int:
        """The number of the run, opened at the first call; ``stored`` are what counts in it.

        Cell file, recipe and the files of the recipe go into it whole. The row is written by a
        task of its own: a Stop must not leave one that nobody closes.
        """
        if self._opening is None:
            self._opening = asyncio.create_task(self._write(recipe, mode, stored))
        await asyncio.wait({self._opening}, timeout=OPEN_TIMEOUT_S)
        if not self._opening.done():
            raise RecordSilent(f"not opened within {OPEN_TIMEOUT_S:g} s")
        self._opening.result()
        return self.number

    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Close it; nothing to close when it was not or could not be opened."""
        if self._opening is None:
            return
        try:
            await self._opening
        except CellError:
            if not self.number:
                return  # there is no record; this is the fault that has ended the run
        await self.store.do(
            RunStore.close_run,
            self.number,
            outcome,
            fault_number=fault.number if fault else None,
            fault=str(fault) if fault else None,
        )
        _log.info("run closed", run=self.number, result=outcome.value)

    async def _write(
        self,
        recipe: Recipe,
        mode: str,
        stored: Sequence[StoredCalibration],
    ) -> None:
        for calibration in stored:
            await self.store.do(RunStore.add_calibration, calibration)
        cell, command = self._cell, self._command
        made_with = await asyncio.to_thread(provenance, cell.config, cell.folder, recipe)
        self.number = await self.store.do(
            RunStore.start_run,
            process=recipe.process,
            serial=command.serial,
            recipe_id=recipe.id,
            recipe_name=recipe.name,
            recipe_hash=made_with.recipe_hash,
            mode=mode,
            software=await asyncio.to_thread(software),
            config_hash=made_with.cell_hash,
            calibration_ids={one.kind: one.id for one in stored},
            simulated=cell.config.simulated,
            operator=command.operator,
        )
        for artefact in made_with.artefacts():
            await self.store.do(RunStore.add_artefact, self.number, *artefact)
