"""A run in Production: one part, made by the steps of a process."""

import asyncio
from typing import Any

from cellctl import log
from cellctl.config.recipe import Recipe
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.errors.records.store import FigureBeyondLimit
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.entries import DRY_RUN, PRODUCTION, RunResult
from cellctl.records.figures import NOT_MEASURED
from cellctl.records.outcome import result_at_end
from cellctl.records.required.required_figures import missing_figures, required_document
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.jobs.earlier_part import Warn, warn_of_earlier_part
from cellctl.runtime.jobs.job import Job
from cellctl.runtime.jobs.record import JobRecord
from cellctl.runtime.process import Prepared, Process, RunContext
from cellctl.runtime.steps import HeldMeanwhile, SafePoint, StepRunner

_log = log.get(__name__)


class ProductionJob(Job):
    """Opens the record before anything moves and closes it whatever happens."""

    makes_part = True

    def __init__(
        self,
        process: Process[Any, Any, Any],
        recipe: Recipe,
        command: UnitCommand,
        safe_point: SafePoint,
        warn: Warn,
    ) -> None:
        self.number = recipe.id
        self.serial = command.serial
        self.line_lost_in_contact = recipe.line_lost_in_contact
        self._interruption = Interruption()
        self._process = process
        self._recipe = recipe
        self._command = command
        self._board = process.services.board
        self._safe_point = safe_point
        self._warn = warn
        self._record = JobRecord(process.services.cell, process.services.store, command)
        self._begun: tuple[Any, Any] | None = None
        """The run of the process, and what its first step takes."""
        self._stored: dict[str, str] = {}
        """Ids of the calibrations that count in the run, by their names."""

    @property
    def run_number(self) -> int:
        """Number of the run in its record; 0 while there is none."""
        return self._record.number

    @property
    def _recorder(self) -> RunRecorder:
        return RunRecorder(self._process.services.store, self.run_number)

    @property
    def outcome(self) -> RunResult:
        """That of the run when it has come to its end."""
        return result_at_end(self._mode)

    @property
    def _mode(self) -> str:
        return DRY_RUN if self._command.dry_run else PRODUCTION

    def interrupt(self, fault: CellError) -> bool:
        """End a step in contact by this fault; False when the process offers no way."""
        return self._interruption.interrupt(fault)

    async def start(self) -> None:
        """Read and check everything, open the record, then bring the cell to the beginning.

        Raises what the process raises, and the faults of the records.
        """
        await self._record.look_at_files(self._recipe)
        # Before the record is opened: a run that lacks a calibration or a drawing has not begun and
        # leaves no record.
        prepared = await self._process.prepare(self._recipe)
        self._stored = _ids(prepared)
        # Before ``begin``, the first call that moves a robot: no motion without a record.
        run = await self._record.open(self._recipe, self._mode, prepared.stored)
        if self._mode == PRODUCTION:
            store = self._process.services.store
            await warn_of_earlier_part(store, self._recipe, self._command, run, self._warn)
        context = RunContext(self._recorder, self._safe_point, self._interruption)
        opened = self._process.open(prepared, context)
        if self._mode == PRODUCTION and (required := self._process.required(opened)):
            await self._recorder.add(required_document(required))
        self._begun = opened, await self._process.begin(opened)

    async def execute(self) -> None:
        """All steps in their order; from the beginning again when the cell was held on the way.

        Raises ``RuntimeError`` before ``start`` has ended.
        """
        if self._begun is None:
            raise RuntimeError("a run is executed before it was started")
        run, state = self._begun
        steps = self._process.steps(self._recipe)
        if self._command.dry_run:
            steps = steps.before_contact()
        runner = StepRunner(
            self._board, self._safe_point, self._recorder, self._command.single_step
        )
        while True:
            try:
                await runner.run(steps, state)
            except HeldMeanwhile:
                _log.info("held meanwhile: everything is measured again")
                await self._require_as_prepared()
                state = await self._process.begin(run)
            else:
                await self._require_figures_within()
                await self._require_still_valid()
                return

    async def _require_as_prepared(self) -> None:
        """Look again, before anything moves, at what the run was prepared with.

        A Hold lasts as long as somebody wants, and the cell is open meanwhile: a head may have been
        exchanged, a calibration may have ended, and the speed may be overridden at the pendant.
        What was read at the beginning goes on to count, as the record has it. Raises what the
        process raises, and ``CalibrationRecordInvalid``.
        """
        found = _ids(await self._process.prepare(self._recipe))
        if others := sorted(dict(self._stored.items() ^ found.items())):
            raise CalibrationRecordInvalid(f"exchanged during a Hold: {', '.join(others)}")

    async def _require_figures_within(self) -> None:
        """Raise ``FigureBeyondLimit``: a run is good with all of its figures or not at all."""
        # Read back from the store, so that the verdict is about what the record says and not about
        # what a step remembers.
        record = await self._process.services.store.do(RunStore.run, self.run_number)
        if beyond := record.beyond_limits:
            raise FigureBeyondLimit(", ".join(f"{one.label} {one.value}" for one in beyond))
        if lacking := missing_figures(record):
            raise FigureBeyondLimit(", ".join(f"{one.label} {NOT_MEASURED}" for one in lacking))

    async def _require_still_valid(self) -> None:
        """Raise ``CalibrationInvalidated`` where somebody has withdrawn a calibration meanwhile.

        Its marker is written beside a running cell, and what was wrong with it has been so in this
        run already.
        """
        calibrations = self._process.services.calibrations
        await asyncio.to_thread(calibrations.require_not_invalidated, self._stored)

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """Close the run record; nothing to close when it could not be opened."""
        self._board.leave_step()
        # These faults stop the run by their reaction, but they are a verdict on the part: the line
        # has to sort it out.
        if isinstance(fault, (FigureBeyondLimit, *self._process.spoiled_by)):
            outcome = RunResult.BAD
        await self._record.close(outcome, fault)
        return outcome


def _ids(prepared: Prepared[Any]) -> dict[str, str]:
    return {one.kind: one.id for one in prepared.stored}
