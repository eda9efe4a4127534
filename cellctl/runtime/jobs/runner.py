"""Runs the job of the unit from its start until its record has been closed, once."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from cellctl import log
from cellctl.cell.time_limits import TimeLimits
from cellctl.config.recipe import LineLostAction
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.errors.records.store import RecordSilent
from cellctl.packml.result import Result
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunResult
from cellctl.records.run_filter import AlarmFilter
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.job import Job

_log = log.get(__name__)

_RESULT_FOR_LINE = {
    RunResult.GOOD: Result.GOOD,
    RunResult.BAD: Result.BAD,
    RunResult.STOPPED: Result.STOPPED,
    RunResult.ABORTED: Result.ABORTED,
    RunResult.INTERRUPTED: Result.ABORTED,
}


@dataclass(frozen=True, slots=True)
class EarlierRun:
    """What the line is shown of the last run before this start."""

    number: int
    """Number of the recipe or procedure."""
    serial: str
    run_number: int


class JobRunner:
    """Holds the present job and remembers the last one. Belongs to one event loop."""

    def __init__(self, time_limits: TimeLimits) -> None:
        self._limits = time_limits
        self._job: Job | None = None
        """The present job, from its start until its record is closed."""
        self._newest: Job | EarlierRun | None = None
        """The present job, or the last one."""
        self._before: tuple[Job | EarlierRun | None, Result] = None, Result.NONE
        """What was shown when the newest job started."""
        self._closing: asyncio.Task[None] | None = None
        self._resting = asyncio.Event()
        """Set while no coroutine of a job runs."""
        self._resting.set()
        self._begun = self._finished = self._given_up = False
        """Whether Starting of the newest job has ended, whether Execute has, and whether its record
        was given up, because the disk did not answer in time."""
        self.result = Result.NONE
        """Result of the newest job; NONE while it is open."""

    @property
    def shown(self) -> Job | EarlierRun | None:
        """The present job, else the last one, else the last run before this start.

        In Starting it is the run before until the record of the new one is open.
        """
        return self._shown_run[0]

    @property
    def shown_result(self) -> Result:
        """Result of the run that is shown; NONE while it is open."""
        return self._shown_run[1]

    @property
    def _shown_run(self) -> tuple[Job | EarlierRun | None, Result]:
        # Without its number the line could not tell which run it sees, so a job is not shown before
        # it has one.
        newest = self._newest
        unrecorded = newest is not None and not (newest.run_number or self._begun)
        return self._before if unrecorded else (newest, self.result)

    async def recall(self, store: AsyncRunStore) -> None:
        """Show the last run before this start, until there is another one.

        A PLC that was waiting for the end of a run when the daemon died reads it here. Raises the
        faults of the store.
        """
        for head in await store.do(RunStore.runs, limit=1):
            self._newest = EarlierRun(head.recipe_id, head.serial, head.number)
            result = head.result
            self.result = Result.NONE if result is None else _RESULT_FOR_LINE[RunResult(result)]
            silent = AlarmFilter(number=RecordSilent.number, run=head.number)
            if await store.do(RunStore.alarm_count, silent):
                # The record was closed after the line had been told that it was not.
                self.result = Result.ABORTED

    @property
    def run_number(self) -> int | None:
        """The open run, if there is one with a record."""
        return (self._job.run_number or None) if self._job else None

    @property
    def line_lost_in_contact(self) -> LineLostAction:
        """What the present job wants to happen when the line is lost while it is in contact."""
        return self._job.line_lost_in_contact if self._job else LineLostAction.KEEP

    def interrupt(self, fault: CellError) -> bool:
        """Have a step in contact end by this fault in its own way; False when none can."""
        return self._job is not None and self._job.interrupt(fault)

    @property
    def makes_part(self) -> bool:
        """True while the present job makes a part."""
        return self._job is not None and self._job.makes_part

    @property
    def outcome(self) -> RunResult | None:
        """How a job that did all it had to do ends; None for one that was cut short."""
        return self._job.outcome if self._job and self._finished else None

    async def start(self, job: Job) -> None:
        """Do what the job does in Starting; ``RecordSilent`` while the last record is open."""
        if self._closing is not None:
            raise RecordSilent("the record of the run before is still being closed")
        self._before = self._shown_run
        self._job = self._newest = job
        self._begun = self._finished = self._given_up = False
        self.result = Result.NONE
        with self._at_work():
            await job.start()
            # From here on a job without a run of its own, such as a procedure that opens it later,
            # is shown all the same.
            self._begun = True

    async def execute(self) -> None:
        """Do what the job does in Execute; ``Unexpected`` when none was started."""
        job = self._job
        if job is None:
            raise Unexpected("Execute without a job")
        with self._at_work():
            await job.execute()
            self._finished = True

    async def left(self) -> None:
        """Wait until a cancelled job has cleaned up: its record must not be closed before."""
        try:
            async with asyncio.timeout(self._limits.leave_s):
                await self._resting.wait()
        except TimeoutError:
            _log.error("the job does not end", timeout_s=self._limits.leave_s)

    async def close(self, outcome: RunResult, fault: CellError | None) -> None:
        """Close the record, once, however often it is asked for: an Abort may overtake a Stop."""
        if self._job is None:
            return
        # A task of its own: an Abort cancels the Stop that waits here, and the record has to be
        # closed all the same.
        if self._closing is None:
            self._closing = asyncio.create_task(self._close(self._job, outcome, fault))
        closing = self._closing  # it drops itself when it ends
        await asyncio.wait({closing}, timeout=self._limits.close_record_s)
        if not closing.done():
            # The line is told at once that this run is not good, and it cannot be told otherwise
            # later.
            self._given_up = True
            self.result = Result.ABORTED
            raise RecordSilent(f"not closed within {self._limits.close_record_s:g} s")
        closing.result()

    async def _close(self, job: Job, outcome: RunResult, fault: CellError | None) -> None:
        try:
            outcome = await job.close(outcome, fault)
            # What the line was told when the disk did not answer stays, whatever the disk says
            # later.
            self.result = Result.ABORTED if self._given_up else _RESULT_FOR_LINE[outcome]
        except CellError:
            self.result = Result.ABORTED  # a part without a record is not a good one
            raise
        finally:
            self._job = self._closing = None

    @contextmanager
    def _at_work(self) -> Iterator[None]:
        # Set again in the ``finally``, so that ``left`` waits for the clean-up of a cancelled job
        # too, in which its robots are stopped.
        self._resting.clear()
        try:
            yield
        finally:
            self._resting.set()
