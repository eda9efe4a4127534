"""What Start asks for: judged before it is taken, turned into a job when the unit starts."""

from cellctl import log
from cellctl.cell.archive import Archive
from cellctl.cell.calibrations import CalibrationFolder
from cellctl.cell.devices import Cell
from cellctl.cell.job import Job
from cellctl.cell.progress import ProgressBoard
from cellctl.errors.internal import Unexpected
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.plc.commands import LineCommand
from cellctl.procedures.maintenance import Maintenance, is_procedure
from cellctl.steps.assembly import PLANNED, Assembly

_log = log.get(__name__)


class OrderDesk:
    """Keeps the last accepted order."""

    def __init__(self, cell: Cell, archive: Archive, board: ProgressBoard) -> None:
        self._cell = cell
        self._archive = archive
        self._board = board
        self._order: tuple[Mode, LineCommand] | None = None
        self.calibrations = CalibrationFolder(cell.folder / cell.config.calibration_dir)

    def judge(self, command: LineCommand, mode: Mode) -> RejectCode:
        """Why Start is refused; remembers the order when it is not."""
        code = RejectCode.NONE
        if mode is Mode.PRODUCTION:
            code = self._judge_production(command)
        elif not is_procedure(command.recipe_id):
            code = RejectCode.RECIPE_UNKNOWN
        if code is RejectCode.NONE:
            self._order = mode, command
        return code

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
        return Maintenance(self._cell, self._archive, self._board, self.calibrations, command)

    def _judge_production(self, command: LineCommand) -> RejectCode:
        if self._cell.config.recipe(command.recipe_id) is None:
            return RejectCode.RECIPE_UNKNOWN
        fault = self.calibrations.fault(PLANNED)
        if fault is not None:
            _log.warning("Start refused", number=fault.number, fault=str(fault))
            return RejectCode.CALIBRATION_INVALID
        return RejectCode.NONE
