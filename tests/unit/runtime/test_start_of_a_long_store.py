"""The unit starts on a store of many runs: it counts the parts and reads the newest run alone."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

from sqlalchemy import event

from cellctl.packml.result import Result
from cellctl.records.database.schema import RunRow
from cellctl.records.entries import MAINTENANCE, PRODUCTION, RunResult
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig
from tests.unit.records.conftest import start

GOOD, BAD = RunResult.GOOD, RunResult.BAD
RUNS = [(PRODUCTION, GOOD)] * 5 + [(PRODUCTION, BAD), (MAINTENANCE, GOOD), (PRODUCTION, BAD)]


@contextmanager
def runs_read() -> Iterator[list[int]]:
    """Numbers of the runs that are read from a database in this block."""
    numbers: list[int] = []

    def loaded(row: RunRow, _context: Any) -> None:
        numbers.append(row.number)

    event.listen(RunRow, "load", loaded)
    try:
        yield numbers
    finally:
        event.remove(RunRow, "load", loaded)


async def test_only_the_newest_run_is_read(rig: DaemonRig) -> None:
    await rig.close()
    with closing(RunStore(rig.store_folder)) as store:
        for mode, result in RUNS:
            store.close_run(start(store, mode=mode), result)
    with runs_read() as numbers:
        await rig.open()
    assert numbers == [len(RUNS)]
    assert rig.unit.parts == 5
    assert rig.unit.jobs.shown is not None
    assert rig.unit.jobs.shown.run_number == len(RUNS)
    assert rig.unit.jobs.shown_result is Result.BAD
