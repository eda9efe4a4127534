"""What is shown of jobs: a run and its result, and neither without the other."""

from cellctl.cell.time_limits import TimeLimits
from cellctl.errors import CellError
from cellctl.packml.result import Result
from cellctl.records.entries import RunResult
from cellctl.runtime.jobs.job import Job
from cellctl.runtime.jobs.runner import JobRunner


class PaperJob(Job):
    """Looks at the runner while its record is not open yet, then opens it as run ``run``."""

    def __init__(self, runner: JobRunner, run: int) -> None:
        self.number = 1
        self.serial = f"SAT-{run}"
        self._runner = runner
        self._run = run
        self._opened = 0
        self.seen: tuple[int, Result] | None = None

    @property
    def run_number(self) -> int:
        return self._opened

    async def start(self) -> None:
        self.seen = shown(self._runner)
        if self._run < 0:
            raise CellError("no record")
        self._opened = self._run

    async def execute(self) -> None:
        pass

    async def close(self, outcome: RunResult, fault: CellError | None) -> RunResult:
        return outcome


def shown(runner: JobRunner) -> tuple[int, Result]:
    job = runner.shown
    return (0 if job is None else job.run_number), runner.shown_result


async def test_the_run_before_is_shown_until_the_record_is_open() -> None:
    runner = JobRunner(TimeLimits())
    first, second = PaperJob(runner, 7), PaperJob(runner, 8)
    await runner.start(first)
    assert first.seen == (0, Result.NONE)
    assert shown(runner) == (7, Result.NONE)
    await runner.close(RunResult.GOOD, None)
    assert shown(runner) == (7, Result.GOOD)
    await runner.start(second)
    assert second.seen == (7, Result.GOOD)
    assert shown(runner) == (8, Result.NONE)


async def test_a_job_without_a_record_changes_nothing_that_is_shown() -> None:
    runner = JobRunner(TimeLimits())
    await runner.start(PaperJob(runner, 7))
    await runner.close(RunResult.GOOD, None)
    for _ in range(2):
        try:
            await runner.start(PaperJob(runner, -1))
        except CellError:
            await runner.close(RunResult.ABORTED, None)
        assert shown(runner) == (7, Result.GOOD)
        assert runner.result is Result.ABORTED
