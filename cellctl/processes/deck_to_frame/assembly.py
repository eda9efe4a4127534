"""A run in Production mode: one deck onto one frame, step by step (mission A)."""

from cellctl.api.modbus.commands import LineCommand
from cellctl.cell.devices import Cell
from cellctl.errors import CellError
from cellctl.errors.vision import SeatedOffPosition
from cellctl.processes.deck_to_frame.journal import Journal
from cellctl.processes.deck_to_frame.preparation import (
    Preparation,
    prepare,
    repeat_until_unheld,
    to_the_beginning,
)
from cellctl.processes.deck_to_frame.recipe import Recipe
from cellctl.processes.deck_to_frame.sequence import Sequence
from cellctl.records.async_store import Archive
from cellctl.records.entries import PRODUCTION, RunResult
from cellctl.runtime.calibration_folder import CalibrationFolder
from cellctl.runtime.job import Job, SafePoint
from cellctl.runtime.job_record import JobRecord
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.step import Step


class Assembly(Job):
    """Opens the record before anything moves and closes it whatever happens."""

    assembles = True

    def __init__(
        self,
        cell: Cell,
        archive: Archive,
        board: ProgressBoard,
        calibrations: CalibrationFolder,
        *,
        recipe: Recipe,
        command: LineCommand,
    ) -> None:
        self.number = recipe.id
        self.serial = command.serial
        self._cell = cell
        self._board = board
        self._folder = calibrations
        self._recipe = recipe
        self._command = command
        self._record = JobRecord(cell, archive, command)
        self._prepared: Preparation | None = None

    @property
    def run_number(self) -> int:
        """Of its record; 0 while there is none."""
        return self._record.number

    @property
    def outcome(self) -> RunResult:
        """A dry run ends without a part: never good."""
        return RunResult.BAD if self._command.dry_run else RunResult.GOOD

    async def start(self) -> None:
        """Read and check everything, open the record, then bring the robots to the beginning.

        Raises the faults of calibrations, feature files, records and robots.
        """
        prepared = self._prepared = await prepare(self._cell, self._folder, self._recipe)
        mode = "dry run" if self._command.dry_run else PRODUCTION
        await self._record.open(self._recipe, mode, prepared.stored, prepared.ids)
        await self._cell.guard.set_compensation(prepared.calibrations.compensation)
        await to_the_beginning(self._cell, self._board)

    async def execute(self, safe_point: SafePoint) -> None:
        """All steps in their order; from the beginning again when the cell was held on the way."""
        assert self._prepared is not None
        journal = Journal(self._record.archive, self._cell.workers, self.run_number)
        sequence = Sequence(
            single_step=self._command.single_step, until_mating=self._command.dry_run
        )
        await repeat_until_unheld(
            sequence,
            cell=self._cell,
            prepared=self._prepared,
            board=self._board,
            journal=journal,
            pause=safe_point,
        )

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """Close the run record; nothing to close when it could not be opened."""
        self._board.update(step=Step.NONE)
        if isinstance(fault, SeatedOffPosition):
            outcome = RunResult.BAD
        await self._record.close(outcome, fault)
        return outcome
