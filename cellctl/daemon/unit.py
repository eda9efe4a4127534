"""The unit: what the cell does in each PackML state."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from cellctl import log
from cellctl.cell.archive import Archive
from cellctl.cell.devices import Cell
from cellctl.cell.job import Job
from cellctl.cell.progress import ProgressBoard
from cellctl.cell.readiness import require_ready
from cellctl.daemon.orders import OrderDesk
from cellctl.daemon.status import StatusView
from cellctl.errors import CellError
from cellctl.errors.line import LineLost
from cellctl.errors.records import RecordsError
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.requests import judge_command, judge_mode
from cellctl.packml.state import State
from cellctl.plc.commands import LineCommand
from cellctl.plc.coupling import LineCoupling
from cellctl.plc.port import PlcPort
from cellctl.plc.result import Result
from cellctl.records.entries import RunResult
from cellctl.records.store import RunStore
from cellctl.steps.positions import lift_off

_log = log.get(__name__)

_TO_THE_LINE = {
    RunResult.GOOD: Result.GOOD,
    RunResult.STOPPED: Result.STOPPED,
    RunResult.ABORTED: Result.ABORTED,
}


class Unit:
    """Joins state machine, devices, records and line. Belongs to one event loop."""

    def __init__(self, cell: Cell, archive: Archive) -> None:
        self._cell = cell
        self._archive = archive
        self._board = ProgressBoard()
        self._desk = OrderDesk(cell, archive, self._board)
        self._job: Job | None = None
        self._last_job: Job | None = None
        self._reports: set[asyncio.Task[object]] = set()
        self._port: PlcPort | None = None
        self._coupling: LineCoupling | None = None
        self._result = Result.NONE
        self.machine = PackMLMachine(
            {
                State.RESETTING: self._resetting,
                State.STARTING: self._starting,
                State.EXECUTE: self._execute,
                State.COMPLETING: self._completing,
                State.STOPPING: self._stopping,
                State.ABORTING: self._aborting,
            },
            initial=State.STOPPED,
        )
        self.machine.on_change.append(self._changed)
        self.machine.on_fault.append(self._faulted)
        self._view = StatusView(cell, self.machine, self._board, self._desk)

    async def open(self) -> int | None:
        """Close runs that an earlier process left open, as interrupted.

        Returns the number of the last command that it took from the line.
        """
        interrupted = await self._archive.do(RunStore.mark_interrupted)
        if interrupted:
            _log.warning("an earlier process left runs open", runs=interrupted)
        return await self._archive.do(RunStore.line_seq)

    def attach(self, port: PlcPort) -> None:
        """Give the unit its line; once, before the port starts."""
        self._port = port
        self._coupling = LineCoupling(self.machine, port.finish, lambda: self._result)

    async def take(self, command: LineCommand) -> RejectCode:
        """A command of the line: note its number, judge what Start asks for, then obey.

        Stop and Abort wait for nothing.
        """
        assert self._coupling is not None
        note = self._archive.do(RunStore.note_line_seq, command.seq)
        if command.ends_motion:
            self._later(note)
        else:
            try:
                await note
            except RecordsError as error:
                self._faulted(error)
                return RejectCode.RECORDS_NOT_READY
        code = self._judge(command)
        return code or await self._coupling.obey(command)

    def _judge(self, command: LineCommand) -> RejectCode:
        """What speaks against a command before anything of it is obeyed."""
        if command.ends_motion:
            return RejectCode.NONE
        active = {fault.number for fault in self.machine.faults}
        if command.alarm_ack_id and command.alarm_ack_id not in active:
            return RejectCode.ALARM_UNKNOWN
        if command.cntrl_cmd != Command.START:
            return RejectCode.NONE
        state, mode = self.machine.state, self.machine.mode
        if command.unit_mode not in (0, mode):
            code = judge_mode(state, command.unit_mode)
            if code is not RejectCode.NONE:
                return code
            mode = Mode(command.unit_mode)
        return judge_command(state, mode, Command.START) or self._desk.judge(command, mode)

    def line_lost(self) -> None:
        """The line's heartbeat stopped: hold at the next safe point."""
        self._later(self.machine.fail(LineLost()))

    def publish(self) -> None:
        """Show the line what is going on."""
        if self._port is not None:
            self._port.publish(self._view.snapshot(self._job or self._last_job, self._result))

    async def _resetting(self) -> None:
        await self._cell.rearm()
        require_ready(self._cell.robots)
        await lift_off(self._cell)

    async def _starting(self) -> None:
        self._result = Result.NONE
        self._board.reset()
        self._job = self._desk.job()
        await self._job.start()

    async def _execute(self) -> None:
        assert self._job is not None
        await self._job.execute(self.machine.safe_point)

    async def _completing(self) -> None:
        await self._close_job(RunResult.GOOD)

    async def _stopping(self) -> None:
        await self._halt(RunResult.STOPPED)

    async def _aborting(self) -> None:
        await self._halt(RunResult.ABORTED)

    async def _halt(self, outcome: RunResult) -> None:
        """Stop everything that moves, then write down how the run ended, in this order."""
        try:
            await self._cell.stop_motion()
        finally:
            await self._close_job(outcome)

    async def _close_job(self, outcome: RunResult) -> None:
        """Nobody but Completing may call a run good, whether or not there is a fault."""
        job, self._job = self._job, None
        if job is not None:
            self._last_job = job
            fault = None if outcome is RunResult.GOOD else self.machine.fault
            with log.bound(run=job.run_number):
                await job.close(outcome, fault)
            self._result = _TO_THE_LINE[outcome]

    def _changed(self, before: State, after: State) -> None:
        if before is not after:
            _log.info("state", state=after.name, was=before.name, mode=self.machine.mode.name)
        self.publish()

    def _faulted(self, error: CellError) -> None:
        _log.error("fault", number=error.number, fault=str(error), remedy=error.remedy)
        run_number = self._job.run_number if self._job else None
        self._later(self._archive.do(RunStore.add_alarm, run_number, error.number, str(error)))
        self.publish()

    def _later(self, work: Coroutine[Any, Any, object]) -> None:
        """What nobody waits for; a failure of it is in the log."""
        task = asyncio.create_task(work)
        self._reports.add(task)
        task.add_done_callback(self._reported)

    def _reported(self, task: asyncio.Task[object]) -> None:
        self._reports.discard(task)
        error = None if task.cancelled() else task.exception()
        if error is not None:
            _log.error("not recorded", fault=str(error))
