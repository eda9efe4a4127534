"""A run in Maintenance mode: one procedure, chosen by its number."""

import asyncio
from collections.abc import Awaitable, Callable
from datetime import timedelta

from cellctl import log
from cellctl.api.modbus.commands import LineCommand
from cellctl.cell.devices import Cell
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationNotStored, ResultOutOfLimits
from cellctl.procedures.base_frame import calibrate_base
from cellctl.procedures.context import ProcedureContext, ProcedureOutcome
from cellctl.procedures.payload import identify_payload_on_cell
from cellctl.procedures.stereo_head import calibrate_head
from cellctl.procedures.stop_latency import measure_stop_latency_on_cell
from cellctl.procedures.target_board import measure_board
from cellctl.processes.deck_to_frame.contact_stiffness import measure_contact_stiffness_on_cell
from cellctl.records.async_store import Archive
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.runtime.calibration_folder import CalibrationFolder
from cellctl.runtime.job import HeldMeanwhile, Job, SafePoint
from cellctl.runtime.job_record import JobRecord
from cellctl.runtime.procedure_registry import ProcedureOrder
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.step import Step

_log = log.get(__name__)

Procedure = Callable[[ProcedureContext], Awaitable[ProcedureOutcome | None]]

PROCEDURES: dict[Step, Procedure] = {
    Step.CALIBRATE_HEAD_1: lambda context: calibrate_head(context, context.cell.head_1),
    Step.CALIBRATE_HEAD_2: lambda context: calibrate_head(context, context.cell.head_2),
    Step.CALIBRATE_BASE_FRAME: calibrate_base,
    Step.CALIBRATE_BOARD_1: lambda context: measure_board(context, context.cell.head_1),
    Step.CALIBRATE_BOARD_2: lambda context: measure_board(context, context.cell.head_2),
    Step.IDENTIFY_PAYLOAD: identify_payload_on_cell,
    Step.MEASURE_STOP_LATENCY: measure_stop_latency_on_cell,
    Step.MEASURE_CONTACT_STIFFNESS: measure_contact_stiffness_on_cell,
}


class Maintenance(Job):
    """Runs a procedure and stores what passed."""

    def __init__(
        self,
        cell: Cell,
        archive: Archive,
        board: ProgressBoard,
        calibrations: CalibrationFolder,
        *,
        order: ProcedureOrder,
        command: LineCommand,
    ) -> None:
        self.number = command.recipe_id
        self.serial = command.serial
        self._cell = cell
        self._archive = archive
        self._board = board
        self._calibrations = calibrations
        self._order = order
        self._command = command
        self._record = JobRecord(cell, archive, command)

    @property
    def run_number(self) -> int:
        """Of its record; only procedures with contact have one."""
        return self._record.number

    async def start(self) -> None:
        """Nothing to bring anywhere: each procedure begins where it needs to."""
        self._board.update(step=self._order.step)

    async def execute(self, safe_point: SafePoint) -> None:
        """Run the procedure, from its beginning again when a Hold has spoilt its measurements.

        Raises ``ResultOutOfLimits`` when the verdict is bad.
        """
        order = self._order
        context = ProcedureContext(
            self._cell, self._calibrations, self._board, safe_point, self._record, order.recipe
        )
        while True:
            try:
                outcome = await PROCEDURES[order.step](context)
                break
            except HeldMeanwhile:
                _log.info("held meanwhile: the procedure begins again")
        if outcome is None:
            _log.info("measured, waiting for its counterpart")
            return
        await self._keep(outcome)

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        """The record is the calibration and the audit log; after contact also a run."""
        step = self._order.step
        self._board.update(step=Step.NONE)
        await self._record.close(outcome, fault)
        ended = {"procedure": step.label, "outcome": outcome.value, "fault": str(fault or "")}
        await self._archive.do(RunStore.audit, self._who, "procedure ended", ended)
        return outcome

    @property
    def _who(self) -> str:
        return self._command.who

    async def _keep(self, outcome: ProcedureOutcome) -> None:
        """Store a result that passed; put a bad one aside for whoever looks for the reason.

        Raises ``CalibrationNotStored``, ``ResultOutOfLimits`` or ``RecordNotWritten``.
        """
        for warning in outcome.warnings:
            _log.warning("calibration", item=outcome.item, warning=warning)
        if not outcome.passed:
            reasons = "; ".join(_failed_checks(outcome)) or "see the record"
            raise ResultOutOfLimits(f"{outcome.item}: {reasons}; {await self._put_aside(outcome)}")
        days = self._cell.config.procedures.validity_days
        stored = await asyncio.to_thread(
            self._calibrations.store,
            outcome.item,
            outcome.record,
            outcome.serial_number,
            timedelta(days=days),
            outcome.picture_png,
        )
        await self._archive.do(RunStore.add_calibration, stored)
        detail = {"item": stored.kind, "id": stored.id, "serial_number": stored.serial_number}
        await self._archive.do(RunStore.audit, self._who, "calibration stored", detail)
        _log.info("calibration stored", item=outcome.item, id=stored.id)

    async def _put_aside(self, outcome: ProcedureOutcome) -> str:
        try:
            folder = await asyncio.to_thread(
                self._calibrations.put_aside, outcome.item, outcome.record, outcome.picture_png
            )
        except CalibrationNotStored as error:
            return f"and not kept: {error.detail}"
        return f"kept in {folder}"


def _failed_checks(outcome: ProcedureOutcome) -> list[str]:
    checks = outcome.record.get("checks", ())
    return [
        f"{check['name']} {check['value']:.4g}, limit {check['limit']:.4g} {check['unit']}".rstrip()
        for check in checks
        if not check["passed"]
    ]
