"""The snapshot that the line sees."""

from cellctl.cell.devices import Cell
from cellctl.cell.job import Job
from cellctl.cell.progress import ProgressBoard
from cellctl.daemon.orders import OrderDesk
from cellctl.errors import CellError
from cellctl.interfaces import RobotMode
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.state import State
from cellctl.plc.result import Result
from cellctl.plc.status import NO_VALUE, CellStatus


class StatusView:
    """Reads devices, machine and progress; changes nothing."""

    def __init__(
        self, cell: Cell, machine: PackMLMachine, board: ProgressBoard, desk: OrderDesk
    ) -> None:
        self._cell = cell
        self._machine = machine
        self._board = board
        self._desk = desk

    def snapshot(self, job: Job | None, result: Result) -> CellStatus:
        """Everything at this moment; ``job`` is the present or the last one."""
        machine, progress = self._machine, self._board.current
        calibrations = self._desk.calibrations
        faults = machine.faults
        return CellStatus(
            state=machine.state,
            state_requested=machine.state_requested,
            mode=machine.mode,
            step=progress.step,
            iteration=progress.iteration,
            ready=machine.state is State.IDLE
            and (machine.mode is not Mode.PRODUCTION or calibrations.all_valid()),
            error=bool(faults),
            calibration_ok=calibrations.all_valid(),
            simulation=self._cell.config.simulated,
            manual=self._any_manual(),
            force_guard_tripped=self._cell.guard.trip is not None,
            hold_requested=machine.hold_requested,
            alarms=tuple(fault.number for fault in faults),
            first_out_alarm=faults[0].number if faults else 0,
            recipe_active=job.number if job else 0,
            run_number=job.run_number if job else 0,
            run_result=result,
            validity_h=calibrations.validity_h(),
            error_mm_deg=progress.error_mm_deg,
            force_peaks=progress.force_peaks,
            force_z_n=self._force_z_n(),
            force_limit_n=progress.force_limit_n,
            serial=job.serial if job else "",
        )

    def _any_manual(self) -> bool:
        for robot in self._cell.robots:
            try:
                if robot.state().mode is not RobotMode.REMOTE:
                    return True
            except CellError:
                continue  # a robot without a fresh state is reported as a fault, not as manual
        return False

    def _force_z_n(self) -> float:
        sample = self._cell.guard.newest()
        return NO_VALUE if sample is None else float(sample.wrench[2])
