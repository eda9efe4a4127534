"""What Start asks for: judged before it is taken, turned into a job when the unit starts."""

import asyncio

from cellctl import log
from cellctl.api.modbus.commands import LineCommand
from cellctl.cell.devices import Cell
from cellctl.cell.readiness import require_ready
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.processes.deck_to_frame.assembly import Assembly
from cellctl.processes.deck_to_frame.preparation import PLANNED
from cellctl.records.async_store import Archive
from cellctl.records.store import RunStore
from cellctl.runtime.calibration_folder import CalibrationFolder
from cellctl.runtime.job import Job
from cellctl.runtime.maintenance import Maintenance
from cellctl.runtime.procedure_registry import procedure_order
from cellctl.runtime.progress import ProgressBoard

_log = log.get(__name__)


class OrderDesk:
    """Keeps the last accepted order."""

    def __init__(self, cell: Cell, archive: Archive, board: ProgressBoard) -> None:
        self._cell = cell
        self._archive = archive
        self._board = board
        self._order: tuple[Mode, LineCommand] | None = None
        self.calibrations = CalibrationFolder(cell.folder / cell.config.calibration_dir)

    async def judge(self, command: LineCommand, mode: Mode) -> RejectCode:
        """Why Start is refused in Idle.

        The state machine itself refuses modes without Start, in other states the whole command.
        """
        return await self._judge_order(command, mode) or _refused(*self._judge_cell())

    def ready(self, mode: Mode) -> bool:
        """Whether some order in this mode would be taken; cheap."""
        allowed = mode is not Mode.PRODUCTION or self.calibrations.all_valid(PLANNED)
        return allowed and self._judge_cell()[0] is RejectCode.NONE

    def place(self, command: LineCommand, mode: Mode) -> None:
        """Remember an order that was judged well, right before the unit starts."""
        self._order = mode, command

    def job(self) -> Job:
        """A new job for the order that was last accepted."""
        if self._order is None:
            raise Unexpected("the unit starts without an order")
        mode, command = self._order
        if mode is Mode.PRODUCTION:
            recipe = self._cell.config.recipe(command.recipe_id)
            if recipe is None:
                raise Unexpected(f"recipe {command.recipe_id} vanished")
            return Assembly(
                self._cell,
                self._archive,
                self._board,
                self.calibrations,
                recipe=recipe,
                command=command,
            )
        order = procedure_order(command.recipe_id, self._cell.config)
        if order is None:
            raise Unexpected(f"procedure {command.recipe_id} vanished")
        return Maintenance(
            self._cell,
            self._archive,
            self._board,
            self.calibrations,
            order=order,
            command=command,
        )

    async def _judge_order(self, command: LineCommand, mode: Mode) -> RejectCode:
        if mode is Mode.PRODUCTION:
            if self._cell.config.recipe(command.recipe_id) is None:
                return RejectCode.RECIPE_UNKNOWN
            newest = await self._archive.do(RunStore.newest_time)
            fault = await asyncio.to_thread(self.calibrations.fault, PLANNED, newest)
            return _refused(RejectCode.CALIBRATION_INVALID, fault)
        if mode is Mode.MAINTENANCE:
            if procedure_order(command.recipe_id, self._cell.config) is None:
                return RejectCode.RECIPE_UNKNOWN
            if command.options:
                return RejectCode.OPTIONS_UNKNOWN  # a procedure is neither dry nor in steps
        return RejectCode.NONE

    def _judge_cell(self) -> tuple[RejectCode, CellError | None]:
        """Why no order at all is taken now."""
        if self._archive.fault is not None:
            return RejectCode.RECORDS_NOT_READY, self._archive.fault
        try:
            require_ready(self._cell.robots)
            self._cell.guard.check()
            for fault in self._cell.unanswered.values():
                return RejectCode.DEVICE_NOT_READY, fault
        except CellError as error:
            return RejectCode.DEVICE_NOT_READY, error
        return RejectCode.NONE, None


def _refused(code: RejectCode, fault: CellError | None) -> RejectCode:
    if fault is None:
        return RejectCode.NONE
    _log.warning("Start refused", number=fault.number, fault=str(fault))
    return code
