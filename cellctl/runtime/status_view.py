"""The snapshot that the line sees."""

from cellctl.api.modbus.status import NO_VALUE, CellStatus
from cellctl.cell.devices import Cell
from cellctl.command.job_factory import OrderDesk
from cellctl.errors import CellError
from cellctl.interfaces import RobotMode
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.runtime.alarms import Alarms
from cellctl.runtime.job import Job
from cellctl.runtime.progress import ProgressBoard


class StatusView:
    """Reads devices, machine and progress; changes nothing and does not raise."""

    def __init__(
        self,
        cell: Cell,
        machine: PackMLMachine,
        board: ProgressBoard,
        desk: OrderDesk,
        alarms: Alarms,
    ) -> None:
        self._cell = cell
        self._machine = machine
        self._board = board
        self._desk = desk
        self._calibrations = desk.calibrations
        self._alarms = alarms

    def snapshot(self, job: Job | None, result: Result, parts: int) -> CellStatus:
        """Everything at this moment; ``job`` is the present or the last one."""
        machine, progress = self._machine, self._board.current
        faults = machine.faults
        alarms = tuple(dict.fromkeys((*self._alarms.numbers, *(f.number for f in faults))))
        return CellStatus(
            state=machine.state,
            state_requested=machine.state_requested,
            mode=machine.mode,
            step=progress.step,
            iteration=progress.iteration,
            ready=self._may_start(),
            error=bool(faults),
            warning=bool(alarms) and not faults,
            calibration_ok=self._calibrations.all_valid(),
            simulation=self._cell.config.simulated,
            manual=self._any_manual(),
            force_guard_tripped=self._cell.guard.trip is not None,
            hold_requested=machine.hold_requested,
            alarms=alarms,
            first_out_alarm=faults[0].number if faults else 0,
            recipe_active=job.number if job else 0,
            cycle_counter=parts,
            run_number=job.run_number if job else 0,
            run_result=result,
            validity_h=self._calibrations.validity_h(),
            error_mm_deg=progress.error_mm_deg,
            force_peaks=progress.force_peaks,
            force_z_n=self._force_z_n(),
            force_limit_n=progress.force_limit_n,
            serial=job.serial if job else "",
        )

    def _may_start(self) -> bool:
        machine = self._machine
        taken = machine.judge(Command.START) is RejectCode.NONE
        return taken and self._desk.ready(machine.mode)

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
