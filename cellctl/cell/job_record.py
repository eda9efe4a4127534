"""The record of one job with contact: opened before anything moves, closed whatever happens."""

import asyncio
import json
from collections.abc import Mapping, Sequence
from hashlib import sha256

from cellctl import __version__, log
from cellctl.calibration.files import StoredCalibration
from cellctl.cell.archive import Archive
from cellctl.cell.devices import Cell
from cellctl.config.base import Section
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.plc.commands import LineCommand
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore

_log = log.get(__name__)


class JobRecord:
    """At most one run row."""

    def __init__(self, cell: Cell, archive: Archive, command: LineCommand) -> None:
        self.archive = archive
        self.number = 0
        """Of the run; 0 until it is open."""
        self._cell = cell
        self._command = command
        self._opening: asyncio.Task[int] | None = None

    async def open(
        self,
        recipe: Recipe,
        mode: str,
        stored: Sequence[StoredCalibration],
        used: Mapping[str, str],
    ) -> int:
        """The number of the run, opened at the first call; ``used`` are identities by kind.

        The row is written by a task of its own: a Stop must not leave one that nobody closes.
        """
        if self._opening is None:
            self._opening = asyncio.create_task(self._write(recipe, mode, stored, used))
        self.number = await asyncio.shield(self._opening)
        return self.number

    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Close it; nothing to close when it was not or could not be opened."""
        if self._opening is None:
            return
        try:
            self.number = await self._opening
        except CellError:
            return  # there is no record; this is the fault that has ended the run
        await self.archive.do(
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
        used: Mapping[str, str],
    ) -> int:
        for calibration in stored:
            await self.archive.do(RunStore.add_calibration, calibration)
        return await self.archive.do(
            RunStore.start_run,
            serial=self._command.serial,
            recipe_id=recipe.id,
            recipe_name=recipe.name,
            recipe_hash=content_hash(recipe),
            mode=mode,
            software=f"cellctl {__version__}",
            config_hash=content_hash(self._cell.config),
            calibration_ids=used,
            simulated=self._cell.config.simulated,
            operator=self._command.order or self._command.by,
        )


def content_hash(section: Section) -> str:
    """SHA-256 of a part of the cell file, independent of its layout."""
    text = json.dumps(section.model_dump(mode="json"), sort_keys=True)
    return sha256(text.encode()).hexdigest()
