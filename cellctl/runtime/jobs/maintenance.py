"""A run in Maintenance mode: one procedure, chosen by its number."""

import asyncio

from cellctl import log
from cellctl.calibration.checks import Checks, checks_from_record
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationNotStored, MeasuredBeyondBound, ResultOutOfLimits
from cellctl.errors.records.store import RecordsError
from cellctl.packml.unit_command import UnitCommand
from cellctl.records.entries import RunResult
from cellctl.records.procedure_entries import (
    CALIBRATION_REJECTED,
    CALIBRATION_STORED,
    PROCEDURE_ENDED,
)
from cellctl.records.replay.procedure_result import STORED, check_figures
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from cellctl.runtime.invalidation import refute
from cellctl.runtime.jobs.job import Job
from cellctl.runtime.jobs.record import JobRecord
from cellctl.runtime.procedure import Procedure, ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices
from cellctl.runtime.steps import HeldMeanwhile, SafePoint

_log = log.get(__name__)


class MaintenanceJob(Job):
    """Runs a procedure and stores what passed."""

    def __init__(
        self,
        services: CellServices,
        procedure: Procedure,
        command: UnitCommand,
        safe_point: SafePoint,
    ) -> None:
        self.number = command.recipe_id
        self.serial = command.serial
        self._store = services.store
        self._board = services.board
        self._calibrations = services.calibrations
        self._procedure = procedure
        self._command = command
        self._record = JobRecord(services.cell, services.store, command)
        self._context = ProcedureContext(services.board, safe_point, self._record)

    @property
    def run_number(self) -> int:
        """Number of the run in its record; 0 while there is none."""
        return self._record.number

    async def start(self) -> None:
        """Open the run record, before anything moves; each procedure begins where it needs to.

        A procedure that works on parts opens its own, with their recipe.
        """
        procedure = self._procedure
        if not procedure.opens_record:
            await self._record.open_procedure(procedure.number, procedure.label)
        self._board.update(
            step=procedure.step, step_label=procedure.label, contact=procedure.contact
        )

    async def execute(self) -> None:
        """Run the procedure, from its beginning again when a Hold has spoilt its measurements.

        Raises ``ResultOutOfLimits`` or ``MeasuredBeyondBound`` when the verdict is bad.
        """
        # From the beginning and not from where it was: boards, heads or payload may have been moved
        # during the Hold.
        while True:
            try:
                outcome = await self._procedure.run(self._context)
                break
            except HeldMeanwhile:
                _log.info("held meanwhile: the procedure begins again")
        if outcome is None:
            _log.info("ended with nothing to store")
            return
        await self._keep(outcome)

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """Close the record of the run, and say in the audit log how the procedure ended."""
        # Before anything that can fail: the line must not see a contact step in a job that has
        # ended.
        self._board.leave_step()
        await self._record.close(outcome, fault)
        ended = {
            "procedure": self._procedure.label,
            "outcome": outcome.value,
            "fault": str(fault or ""),
        }
        await self._store.do(RunStore.audit, self._who, PROCEDURE_ENDED, ended)
        return outcome

    @property
    def _who(self) -> str:
        return self._command.who

    async def _keep(self, outcome: ProcedureOutcome) -> None:
        """Store a result that passed; put a bad one aside for whoever looks for the reason.

        Raises ``CalibrationNotStored``, ``ResultOutOfLimits``, ``MeasuredBeyondBound`` or
        ``RecordNotWritten``.
        """
        for warning in outcome.warnings:
            _log.warning("calibration", item=outcome.kind.name, warning=warning)
        await self._keep_figures(outcome)
        if not outcome.passed:
            reasons = "; ".join(_failed_checks(outcome)) or "see the record"
            # Kept, so that somebody can see from its picture and residuals why it failed. A disk
            # that refuses it must not hide the verdict.
            aside = await self._put_aside(outcome)
            why = f"{outcome.kind.name}: {reasons}; {aside}"
            await self._tell_rejected(outcome, f"{reasons}; {aside}")
            if not _refutes_bound(outcome):
                raise ResultOutOfLimits(why)
            fault = MeasuredBeyondBound(why)
            await refute(outcome.kind, fault, self._calibrations, self._store)
            raise fault
        # The folder is what production reads, so it comes before the run store, which only keeps
        # the history.
        stored = await asyncio.to_thread(
            self._calibrations.store,
            outcome.kind,
            outcome.record,
            outcome.serial_number,
            self._procedure.valid_for,
            outcome.picture_png,
        )
        await self._store.do(RunStore.add_calibration, stored)
        detail = {"item": stored.kind, "id": stored.id, "serial_number": stored.serial_number}
        if self.run_number:
            await RunRecorder(self._store, self.run_number).document(STORED, detail)
        await self._store.do(RunStore.audit, self._who, CALIBRATION_STORED, detail)
        _log.info("calibration stored", item=outcome.kind.name, id=stored.id)

    async def _keep_figures(self, outcome: ProcedureOutcome) -> None:
        """Record the figures of a result that has failed, too: they say how far it is off."""
        if not self.run_number:
            return
        try:
            await RunRecorder(self._store, self.run_number).figures(
                check_figures(outcome.kind.name, outcome.record)
            )
        except RecordsError as error:
            # A disk that refuses them must not hide a bad verdict.
            if outcome.passed:
                raise
            _log.error("figures not kept", run=self.run_number, fault=str(error))

    async def _tell_rejected(self, outcome: ProcedureOutcome, why: str) -> None:
        """The store keeps no such result; its audit log says that there was one, and why."""
        detail = {"item": outcome.kind.name, "run": self.run_number, "reason": why}
        try:
            await self._store.do(RunStore.audit, self._who, CALIBRATION_REJECTED, detail)
        except RecordsError as error:
            # A disk that refuses it must not hide the verdict.
            _log.error("rejection not kept", run=self.run_number, fault=str(error))

    async def _put_aside(self, outcome: ProcedureOutcome) -> str:
        try:
            folder = await asyncio.to_thread(
                self._calibrations.put_aside, outcome.kind, outcome.record, outcome.picture_png
            )
        except CalibrationNotStored as error:
            return f"and not kept: {error.detail}"
        return f"kept in {folder}"


def _checks(outcome: ProcedureOutcome) -> Checks:
    # What a process of another package gives need not have any.
    return checks_from_record(outcome.record.get("checks", ()))


def _refutes_bound(outcome: ProcedureOutcome) -> bool:
    """Whether the measurement is good but for the bounds that it exceeds.

    Where something else fails too, the measurement itself is in doubt and refutes nothing.
    """
    failed = {check.name for check in _checks(outcome) if not check.passed}
    return bool(failed) and failed <= outcome.bounds


def _failed_checks(outcome: ProcedureOutcome) -> list[str]:
    return [
        f"{check.name} {check.value:.4g}, limit {check.limit:.4g} {check.unit}".rstrip()
        for check in _checks(outcome)
        if not check.passed
    ]
