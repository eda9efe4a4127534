"""The unit: what the cell does in each PackML state."""

import asyncio

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
from cellctl.packml.command import Command
from cellctl.packml.machine import PackMLMachine
from cellctl.packml.mode import Mode
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.plc.commands import LineCommand
from cellctl.plc.coupling import LineCoupling
from cellctl.plc.port import PlcPort
from cellctl.plc.result import Result
from cellctl.records.store import RunStore
from cellctl.steps.positions import lift_off

_log = log.get(__name__)


class Unit:
    """Joins state machine, devices, records and line. Belongs to one event loop."""

    def __init__(self, cell: Cell, archive: Archive) -> None:
        self._cell = cell
        self._archive = archive
        self._board = ProgressBoard()
        self._desk = OrderDesk(cell, archive, self._board)
        self._job: Job | None = None
        self._last_job: Job | None = None
        self._reports: set[asyncio.Task[None]] = set()
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

    async def open(self) -> None:
        """Close runs that an earlier process left open, as interrupted."""
        interrupted = await self._archive.do(RunStore.mark_interrupted)
        if interrupted:
            _log.warning("an earlier process left runs open", runs=interrupted)

    def attach(self, port: PlcPort) -> None:
        """Give the unit its line; once, before the port starts."""
        self._port = port
        self._coupling = LineCoupling(self.machine, port.finish, lambda: self._result)

    async def take(self, command: LineCommand) -> RejectCode:
        """A command of the line: judge what Start asks for, then obey."""
        assert self._coupling is not None
        if command.cntrl_cmd == Command.START:
            mode = Mode(command.unit_mode) if command.unit_mode else self.machine.mode
            code = self._desk.judge(command, mode)
            if code is not RejectCode.NONE:
                return code
        return await self._coupling.obey(command)

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
        await self._close_job(stopped=False)

    async def _stopping(self) -> None:
        await self._halt(stopped=True)

    async def _aborting(self) -> None:
        await self._halt(stopped=False)

    async def _halt(self, *, stopped: bool) -> None:
        """Stop everything that moves, then write down how the run ended, in this order."""
        try:
            await self._cell.stop_motion()
        finally:
            await self._close_job(stopped=stopped)

    async def _close_job(self, *, stopped: bool) -> None:
        job, self._job = self._job, None
        if job is not None:
            self._last_job = job
            with log.bound(run=job.run_number):
                self._result = await job.close(self.machine.fault, stopped=stopped)

    def _changed(self, before: State, after: State) -> None:
        if before is not after:
            _log.info("state", state=after.name, was=before.name, mode=self.machine.mode.name)
        self.publish()

    def _faulted(self, error: CellError) -> None:
        _log.error("fault", number=error.number, fault=str(error), remedy=error.remedy)
        run_number = self._job.run_number if self._job else None
        self._later(self._archive.do(RunStore.add_alarm, run_number, error.number, str(error)))
        self.publish()

    def _later(self, work) -> None:  # type: ignore[no-untyped-def]
        task = asyncio.ensure_future(work)
        self._reports.add(task)
        task.add_done_callback(self._reports.discard)
