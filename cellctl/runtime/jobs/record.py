"""The record of one job: opened before anything moves, closed whatever happens."""

import asyncio
from collections.abc import Sequence
from hashlib import sha256
from typing import Any

from cellctl import log
from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.cell.devices import Cell
from cellctl.clock import utc_now
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.records.store import RecordNotWritten, RecordsError, RecordSilent, StoreLocked
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import MAINTENANCE, Document, RunResult
from cellctl.records.files.unwritten_end import UnwrittenEnd
from cellctl.records.parts import MATE_SERIAL, PARTS
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.motion_recorder import MotionRecorder
from cellctl.runtime.jobs.provenance import Provenance, cell_artefact, provenance
from cellctl.runtime.jobs.told_devices import told_devices
from cellctl.version import software

_log = log.get(__name__)

CLOSE_PATIENCE_S = 120.0
"""A run that is not closed is never good: the next start closes it with its fault, or as
interrupted. Nothing moves meanwhile, so a backup that holds the store for a minute is waited
for."""


class JobRecord:
    """Opens and closes the record of one job; a job has at most one."""

    def __init__(self, cell: Cell, store: AsyncRunStore, command: UnitCommand) -> None:
        self.store = store
        self.number = 0
        """Number of the run; 0 until it is open."""
        self._cell = cell
        self._command = command
        self._read_before: Provenance | None = None
        """The files of the recipe as they were before the run was prepared; None where it reads
        none."""
        self._opening: asyncio.Task[None] | None = None
        self._motion: MotionRecorder | None = None

    async def look_at_files(self, recipe: Recipe) -> None:
        """Remember the files of a recipe; to be called before anybody reads what a run goes by.

        The record keeps them as they are when it is opened. A drawing that is saved in between
        would be in the record of a run that was measured by another one. Raises
        ``FeatureFileInvalid``.
        """
        self._read_before = await self._provenance(recipe)

    async def open(
        self,
        recipe: Recipe,
        mode: str,
        stored: Sequence[StoredCalibration],
    ) -> int:
        """The number of the run, opened at the first call; ``stored`` are what counts in it.

        Cell file, recipe and the files of the recipe go into it whole. The row is written by a
        task of its own: a Stop must not leave one that nobody closes. Raises ``FeatureFileInvalid``
        for files that are others than ``look_at_files`` has seen.
        """
        if self._opening is None:
            self._opening = asyncio.create_task(self._write(recipe, mode, stored))
        return await self._opened(self._opening)

    async def open_procedure(self, number: int, label: str) -> int:
        """The number of the run of a procedure without parts, opened at the first call.

        It has the procedure in place of a recipe; the cell file goes into it whole.
        """
        if self._opening is None:
            self._opening = asyncio.create_task(self._write_procedure(number, label))
        return await self._opened(self._opening)

    def recorded_at_s(self, time_s: float) -> float | None:
        """A monotonic time as the recording of the run has it, from its start; None without one."""
        return None if self._motion is None else time_s - self._motion.start_s

    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Close the record; does nothing when it was never opened or could not be opened."""
        if self._opening is None:
            return
        try:
            await self._opening
        except CellError:
            if not self.number:
                return  # there is no record; this is the fault that has ended the run
        if self._motion is not None:
            await self._keep_motion(self._motion)
        # Images are written in the background and belong to the seal, which covers every file of
        # the run at its closing.
        await self.store.images_kept()
        try:
            await self.store.insist(
                CLOSE_PATIENCE_S,
                RunStore.close_run,
                self.number,
                outcome,
                fault_number=fault.number if fault else None,
                fault=str(fault) if fault else None,
            )
        except (RecordNotWritten, StoreLocked) as unwritten:
            await self.store.keep_end(self.number, _unwritten_end(outcome, fault, unwritten))
            raise
        _log.info(
            "run closed", run=self.number, result=outcome.value, ledger_head=await self._head()
        )

    async def _head(self) -> str:
        """For the journal, which is another place than the store: it shows a run that was cut off
        the ledger."""
        try:
            return str(await self.store.do(RunStore.ledger_head))
        # The run is closed and sealed: a part is no worse for a line of the journal.
        except RecordsError as error:
            return f"not read: {error}"

    async def _keep_motion(self, motion: MotionRecorder) -> None:
        try:
            await motion.finish()
            await self.store.do(RunStore.keep_recording, self.number)
        # The recording serves later questions, as raw images do. Without it the run has to be
        # closed all the same.
        except RecordsError as error:
            _log.error("motion not kept", run=self.number, fault=str(error))

    async def _opened(self, opening: "asyncio.Task[None]") -> int:
        # Waited for and not awaited: a time-out or a Stop must not cancel the task that is writing
        # the row.
        limit_s = self._cell.time_limits.open_record_s
        await asyncio.wait({opening}, timeout=limit_s)
        if not opening.done():
            raise RecordSilent(f"not opened within {limit_s:g} s")
        opening.result()
        return self.number

    async def _write(
        self,
        recipe: Recipe,
        mode: str,
        stored: Sequence[StoredCalibration],
    ) -> None:
        # The rows of the calibrations first: the run names them by their ids.
        for calibration in stored:
            await self.store.do(RunStore.add_calibration, calibration)
        made_with = await self._provenance(recipe)
        if self._read_before is not None:
            made_with.require_same_files(self._read_before)
        await self._start(
            process=recipe.process,
            recipe_id=recipe.id,
            recipe_name=recipe.name,
            recipe_hash=made_with.recipe_hash,
            mode=mode,
            config_hash=made_with.cell_hash,
            calibration_ids={one.kind: one.id for one in stored},
        )
        for artefact in made_with.artefacts():
            await self.store.do(RunStore.add_artefact, self.number, *artefact)
        await self.store.do(RunStore.add, self.number, told_devices(self._cell))
        if self._command.mate_serial:
            named = Document(PARTS, {MATE_SERIAL: self._command.mate_serial})
            await self.store.do(RunStore.add, self.number, named)

    async def _provenance(self, recipe: Recipe) -> Provenance:
        cell = self._cell
        return await asyncio.to_thread(provenance, cell.config, cell.folder, recipe)

    async def _write_procedure(self, number: int, label: str) -> None:
        cell_file = cell_artefact(self._cell.config)
        cell_hash = sha256(cell_file[1]).hexdigest()
        await self._start(
            process=MAINTENANCE,
            recipe_id=number,
            recipe_name=label,
            recipe_hash=cell_hash,
            mode=MAINTENANCE,
            config_hash=cell_hash,
            calibration_ids={},
        )
        await self.store.do(RunStore.add_artefact, self.number, *cell_file)
        await self.store.do(RunStore.add, self.number, told_devices(self._cell))

    async def _start(self, **made_with: Any) -> None:
        """Write the row with what it was made with, and who commanded it.

        Raises ``DiskNearlyFull``, should the room have gone since Start was taken: better now than
        with the part in contact.
        """
        await self.store.look_for_room()
        if self.store.scarcity is not None:
            raise self.store.scarcity
        self.number = await self.store.do(
            RunStore.start_run,
            serial=self._command.serial,
            operator=self._command.operator,
            software=await asyncio.to_thread(software),
            simulated=self._cell.config.simulated,
            **made_with,
        )
        cell = self._cell
        file = await self.store.do(RunStore.open_recording, self.number)
        self._motion = MotionRecorder(
            cell.robots, cell.guards, cell.robot_notes, cell.run_notes, file
        ).start()


def _unwritten_end(
    outcome: RunResult, fault: CellError | None, unwritten: RecordsError
) -> UnwrittenEnd:
    """What the next start writes in the record: the fault that ended the run, and why it is late.

    The line was told that the run was aborted, so its part is not good.
    """
    late = f"the end of the run could not be recorded ({unwritten}); written at the next start"
    return UnwrittenEnd(
        utc_now(),
        RunResult.ABORTED if outcome is RunResult.GOOD else outcome,
        (fault or unwritten).number,
        f"{fault}; {late}" if fault else f"{unwritten}; written at the next start",
    )
