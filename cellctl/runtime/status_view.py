"""The snapshot that the line sees."""

from collections.abc import Callable

from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.devices import Cell
from cellctl.clock import Monotonic, now_s
from cellctl.errors import CellError
from cellctl.guard.health import is_present
from cellctl.interfaces import RobotMode
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.runtime.alarms import Alarms
from cellctl.runtime.cell_status import NO_VALUE, CellStatus, ShownRefusal
from cellctl.runtime.jobs.factory import JobFactory
from cellctl.runtime.jobs.job import Job
from cellctl.runtime.jobs.runner import EarlierRun
from cellctl.runtime.progress import ProgressBoard


class StatusView:
    """Reads devices, machine and progress; changes nothing and does not raise."""

    def __init__(
        self,
        cell: Cell,
        *,
        machine: PackMLMachine,
        board: ProgressBoard,
        jobs: JobFactory,
        calibrations: CalibrationStore,
        alarms: Alarms,
        awaits_trips: Callable[[str], bool],
        clock: Monotonic = now_s,
    ) -> None:
        """``awaits_trips`` says of a force sensor whether a step deals with its trips itself."""
        self._cell = cell
        self._machine = machine
        self._board = board
        self._jobs = jobs
        self._calibrations = calibrations
        self._alarms = alarms
        self._awaits_trips = awaits_trips
        self._now_s = clock

    def snapshot(self, job: Job | EarlierRun | None, result: Result, parts: int) -> CellStatus:
        """The state of the cell at this moment; ``job`` is the present or the last one."""
        machine, progress, time_s = self._machine, self._board.current, self._now_s()
        faults = machine.faults
        # An alarm stays active when its fault was released, and a fault stays latched when its
        # alarm was acknowledged: the line sees both, and each number once.
        alarms = tuple(dict.fromkeys((*self._alarms.numbers, *(f.number for f in faults))))
        return CellStatus(
            state=machine.state,
            state_requested=machine.state_requested,
            mode=machine.mode,
            step=progress.step,
            step_label=progress.step_label,
            iteration=progress.iteration,
            ready=self._may_start(),
            error=bool(faults),
            warning=bool(alarms) and not faults,
            calibration_ok=self._calibrations.all_valid(self._calibrations.kinds),
            simulation=self._cell.config.simulated,
            manual=self._any_manual(),
            force_guard_tripped=self._force_guard_tripped(),
            hold_requested=machine.hold_requested,
            safe_point_ahead=progress.safe_point_ahead,
            stop_not_confirmed=bool(self._cell.unstopped),
            alarms=alarms,
            first_out_alarm=faults[0].number if faults else 0,
            recipe_active=job.number if job else 0,
            cycle_counter=parts,
            run_number=job.run_number if job else 0,
            run_result=result,
            validity_h=self._calibrations.validity_h(self._calibrations.kinds),
            validity_least_h=self._calibrations.least_h(self._calibrations.kinds),
            error_mm_deg=progress.error_mm_deg,
            force_peaks=progress.force_peaks,
            force_z_n=self._force_z_n(),
            force_limit_n=progress.force_limit_n,
            serial=job.serial if job else "",
            mode_time_s=time_s - machine.mode_since_s,
            state_time_s=time_s - machine.state_since_s,
            refusals=tuple(
                ShownRefusal(time_s - one.time_s, one.mode, one.state, one.number, one.code)
                for one in reversed(machine.refusals)
            ),
        )

    def _may_start(self) -> bool:
        machine = self._machine
        taken = machine.validate(Command.START) is RejectCode.NONE
        return taken and self._jobs.ready(machine.mode)

    def _any_manual(self) -> bool:
        for robot in self._cell.robots.values():
            try:
                if robot.state().mode is not RobotMode.REMOTE:
                    return True
            except CellError:
                continue  # a robot without a fresh state is reported as a fault, not as manual
        return False

    def is_awaited_touch(self, sensor_name: str) -> bool:
        """Whether the guard of a sensor has stopped its robot at the touch that a step looks for.

        Every mating finds its touch, and whoever takes that for an alarm would have one with every
        good part. A touch that nobody waits for, or waits for no more, is a trip.
        """
        trip = self._cell.guards[sensor_name].trip
        return trip is not None and trip.touch and self._awaits_trips(sensor_name)

    def _force_guard_tripped(self) -> bool:
        return any(
            guard.trip is not None and not self.is_awaited_touch(name)
            for name, guard in self._cell.guards.items()
        )

    def _force_z_n(self) -> float:
        """Fz of the first force sensor in the cell file: the register has room for one sensor.

        The register map says that it is along z of the part, without gravity. As long as no payload
        is known there is no gravity to remove, and the sensor's own axes may look the other way, so
        that the sign would be wrong: in both cases there is no value. Nor is there one when nothing
        has come from the sensor for a while, whether it is silent or its guard has died.
        """
        guard = next(iter(self._cell.guards.values()), None)
        sample = None if guard is None else guard.newest()
        if guard is None or sample is None or not is_present(sample, self._now_s()):
            return NO_VALUE
        if not (guard.gravity_compensated and guard.in_part_frame):
            return NO_VALUE
        return float(sample.wrench[2])
