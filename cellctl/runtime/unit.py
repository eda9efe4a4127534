"""The unit controller: it carries out what the cell does in each PackML state."""

import asyncio

from cellctl import log
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.arm_loads import require_selected_loads
from cellctl.cell.devices import Cell
from cellctl.cell.readiness import require_ready
from cellctl.cell.reconnecting import reconnect
from cellctl.clock import Monotonic, now_s
from cellctl.config.recipe import LineLostAction
from cellctl.errors import CellError
from cellctl.errors.internal import StateDidNotEnd
from cellctl.errors.line import LineLost, LineLostInContact
from cellctl.errors.robot import StopFailed
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import STATES, State
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.runtime.alarms import Alarms
from cellctl.runtime.background import Background
from cellctl.runtime.interrupted import faults_of_before
from cellctl.runtime.invalidation import invalidate_after
from cellctl.runtime.jobs.factory import JobFactory
from cellctl.runtime.jobs.runner import JobRunner
from cellctl.runtime.process import CellServices, calibration_kinds, open_processes
from cellctl.runtime.progress import ProgressBoard, on_new_message
from cellctl.runtime.state_notes import note_states
from cellctl.runtime.status_view import StatusView

_log = log.get(__name__)

MAY_MOVE = frozenset({Command.RESET, Command.START, Command.UNHOLD, Command.UNSUSPEND})
"""Commands after which a robot may move."""
_CLEARED = frozenset(STATES) - {State.ABORTING, State.ABORTED, State.CLEARING}
"""States that the unit reaches only through a Clear that succeeded: its devices are connected."""
AT_REST = frozenset({State.STOPPED, State.IDLE, State.COMPLETED, State.ABORTED})
"""States in which the unit waits for a command and no robot is being moved."""


class UnitController:
    """Joins state machine, devices and records. Belongs to one event loop."""

    def __init__(self, cell: Cell, store: AsyncRunStore, clock: Monotonic = now_s) -> None:
        """Raises ``UnknownDriver`` when a process of the cell file is not installed."""
        self._cell = cell
        self._store = store
        self._jobs = JobRunner(cell.time_limits)
        self.board = ProgressBoard()
        # In the log, too: it shall say later what the arm was doing when something happened.
        self.board.observers.append(on_new_message(lambda text: _log.info("doing", text=text)))
        self.background = Background()
        self.alarms = Alarms(store, self.background)
        self.calibrations = CalibrationStore(
            cell.folder / cell.config.calibration_dir, calibration_kinds(cell.config)
        )
        services = CellServices(cell, self.calibrations, self.board, store)
        self._processes = open_processes(services)
        self.factory = JobFactory(services, self._processes)
        self.machine = PackMLMachine(
            {
                State.CLEARING: self._clearing,
                State.RESETTING: self._resetting,
                State.STARTING: self._starting,
                State.EXECUTE: self._execute,
                State.COMPLETING: self._completing,
                State.STOPPING: self._stopping,
                State.ABORTING: self._aborting,
            },
            gate=self._gate,
        )
        cell.pace.in_maintenance = lambda: self.machine.mode is Mode.MAINTENANCE
        self._ending = False
        self._interrupted: list[int] | None = None
        """Runs that an earlier process left open; None once somebody was told what it has left."""
        self.machine.on_change.append(self._changed)
        self.machine.on_fault.append(self._faulted)
        note_states(self.machine, self.board, cell.run_notes)
        self.view = StatusView(
            cell,
            machine=self.machine,
            board=self.board,
            jobs=self.factory,
            calibrations=self.calibrations,
            alarms=self.alarms,
            awaits_trips=self.awaits_trips,
            clock=clock,
        )
        self.parts = 0
        """Good parts since installation."""

    async def open(self) -> None:
        """Close runs that an earlier process left open; take over its alarms.

        Raises the faults of the store, and ``CalibrationNotStored`` while no procedure could keep
        its result.
        """
        # Asked at the start: a procedure of ten minutes must not find out at its end that its
        # result cannot be kept.
        await asyncio.to_thread(self.calibrations.require_writable)
        self._interrupted = await self._store.do(RunStore.mark_interrupted)
        if self._interrupted:
            _log.warning("an earlier process left runs open", runs=self._interrupted)
        await self.alarms.open()
        await self._jobs.recall(self._store)
        # Parts are counted since installation, and only the records know that.
        self.parts = await self._store.do(RunStore.good_parts)

    async def come_up(self) -> None:
        """Connect the devices, as Clear does; then the unit is Stopped, else Aborted by a fault."""
        await self.machine.command(Command.CLEAR)
        await self.machine.wait_for(*_CLEARED, State.ABORTED)

    async def until_live(self) -> None:
        """Wait until a Clear has connected the devices."""
        await self.machine.wait_for(*_CLEARED)

    @property
    def live(self) -> bool:
        """True while all devices are connected and the daemon does not end: robots may move."""
        return self._cell.connected and not self._ending

    @property
    def jobs(self) -> JobRunner:
        """Runs the present job, and remembers the last one."""
        return self._jobs

    def log_facts(self) -> dict[str, object]:
        """Run and step of this moment, for every line of the log; empty without an open run."""
        run, step = self._jobs.run_number, self.board.current.step_label
        known = {"run": run, "step": step or None}
        return {name: value for name, value in known.items() if run and value}

    def awaits_trips(self, sensor_name: str) -> bool:
        """True while a step or a move deals with the trips of this guard itself."""
        return self._cell.awaits_trips(sensor_name) or self.board.current.contact

    def line_lost(self) -> None:
        """The line's heartbeat stopped: hold at the next safe point; in contact as the job says."""
        self.background.start(self._lose_line())

    async def close(self, fault: CellError | None = None) -> None:
        """Abort what runs, because of ``fault`` if there is one, and wait for the records.

        Nothing begins to move any more, whatever the line asks for. Gives up after a while: the
        links are dropped next, and robots without a link stop.
        """
        # First of all, so that no command that is waiting for its turn can start a motion while the
        # unit is being closed.
        self._ending = True
        abort_s = self._cell.time_limits.abort_s
        try:
            async with asyncio.timeout(abort_s):
                if fault is not None:
                    await self.machine.fail(fault)
                if self.machine.state not in AT_REST:
                    await self.machine.command(Command.ABORT)
                    await self.machine.wait_for(State.ABORTED, timeout_s=abort_s)
        except TimeoutError:
            state = self.machine.state.name
            late = StateDidNotEnd(f"{state} lasts more than {abort_s:g} s")
            _log.error("fault", number=late.number, fault=str(late), remedy=late.remedy)
        await self.machine.close()
        await self.background.drain()

    async def _lose_line(self) -> None:
        touches = self.machine.state is State.EXECUTE and self.board.current.contact
        action = self._jobs.line_lost_in_contact
        # ``LineLost`` leads to Holding: Execute goes on to its next safe point, of which a contact
        # step has none.
        if not touches or action is LineLostAction.FINISH:
            await self.machine.fail(LineLost())
            return
        fault = LineLostInContact(f"in step {self.board.current.step_label}")
        # What cannot leave the contact in its own way is stopped like everything else.
        if action is not LineLostAction.BACK_OFF or not self._jobs.interrupt(fault):
            await self.machine.fail(fault)

    async def _clearing(self) -> None:
        # Before the devices: a worker that has died is not found by connecting, and every
        # measurement needs one.
        self._cell.workers.revive()
        # Whoever clears says that the robots stand: one that was given up gets its links back.
        if not self._cell.connected or self._cell.unstopped:
            await self._cell.connect()
        else:
            await reconnect({**self._cell.grippers, **self._cell.digital_ios})
        # Once the devices are there: before, nobody knows where an arm stands.
        if self._interrupted is not None:
            await self._tell_of(self._interrupted)
            # Last of all: a Clear that is cut short here has told nobody, and the next one does.
            self._interrupted = None

    async def _tell_of(self, runs: list[int]) -> None:
        processes = self._processes.values()
        for run, fault in await faults_of_before(runs, self._cell, processes, self._store):
            _log.warning("left from before", number=fault.number, fault=str(fault))
            self.alarms.add(fault, run)

    async def _resetting(self) -> None:
        # Clear has released the fault, the latches of robots and guards are released here: nothing
        # moves before somebody has asked for a Reset.
        await self._cell.rearm()
        require_ready(self._cell.robots.values())
        await require_selected_loads(self._cell.robots.values(), self._cell.config.robots)
        for process in self._processes.values():
            await process.clear()

    async def _starting(self) -> None:
        self.board.reset()
        await self._jobs.start(self.factory.job(self._safe_point, self.machine.fail))

    async def _execute(self) -> None:
        await self._jobs.execute()

    async def _completing(self) -> None:
        """A run that Complete cut short ends like a stopped one, and its part is not good."""
        outcome = self._jobs.outcome
        if outcome is None:
            await self._halt(RunResult.BAD)
            return
        assembled = self._jobs.makes_part and outcome is RunResult.GOOD
        await self._jobs.close(outcome, None)
        # Counted only when the record is closed: a part without a record is not a good one.
        self.parts += assembled

    async def _stopping(self) -> None:
        await self._halt(RunResult.STOPPED)

    async def _aborting(self) -> None:
        await self._halt(RunResult.ABORTED)

    async def _halt(self, outcome: RunResult) -> None:
        """Stop everything that moves, then write down how the run ended, in this order."""
        error = await self._stop_motion()
        # The job may still be cleaning up. Its last entries have to be in the record before it is
        # sealed.
        await self._jobs.left()
        try:
            await self._jobs.close(outcome, self.machine.fault)
        except CellError as unrecorded:
            if error is None:
                raise
            # An arm that may still move matters more than its record; this is an alarm beside it.
            self._faulted(unrecorded)
        if error is not None:
            raise error

    async def _stop_motion(self) -> BaseException | None:
        """Stop all motion; what went wrong, or None: the run is closed before a fault is raised.

        A driver that never comes back must not keep the run from its end.
        """
        stop_s = self._cell.time_limits.stop_s
        stopping = asyncio.create_task(self._cell.stop_motion())
        try:
            done, _ = await asyncio.wait({stopping}, timeout=stop_s)
        finally:
            # Nobody waits for a driver any more that has not come back; the state ends with a fault
            # instead.
            stopping.cancel()
        if not done:
            return StopFailed(f"a driver has not come back from its stop in {stop_s:g} s")
        return stopping.exception()

    async def _safe_point(self, *, hold: bool = False) -> bool:
        if hold:
            # Single step asks for its Hold like anybody else, so that state and line show it in the
            # same way.
            await self.machine.command(Command.HOLD)
        return await self.machine.safe_point()

    def _gate(self, _state: State, command: Command) -> RejectCode:
        """Refuse what may move a robot while one of them is not connected, or the daemon ends."""
        refused = command in MAY_MOVE and not self.live
        return RejectCode.DEVICE_NOT_READY if refused else RejectCode.NONE

    def _changed(self, before: State, after: State) -> None:
        if before is not after:
            _log.info("state", state=after.name, was=before.name, mode=self.machine.mode.name)

    def _faulted(self, error: CellError) -> None:
        _log.error("fault", number=error.number, fault=str(error), remedy=error.remedy)
        self.alarms.add(error, self._jobs.run_number)
        # In the background: observers of the machine must neither wait for the disk nor raise.
        self.background.start(self._invalidate_after(error))

    async def _invalidate_after(self, error: CellError) -> None:
        try:
            await invalidate_after(error, self.calibrations, self._store)
        except CellError as fault:
            await self.machine.fail(fault)
