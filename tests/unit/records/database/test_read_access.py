"""Another user than the daemon's, who may read the files and write none."""

import multiprocessing
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest

from cellctl.errors.records.store import RecordsError, StoreUnavailable
from cellctl.records import RunStore
from cellctl.records.database.read_access import ReadAccess
from cellctl.records.database.schema_version import FILE
from cellctl.records.run_list import listed_runs
from tests.unit.records.conftest import start

NOBODY = 65534
pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="to become another user wants root")


@pytest.fixture
def folder() -> Iterator[Path]:
    # Not below a folder of pytest, into which nobody else may look.
    with tempfile.TemporaryDirectory(prefix="cellctl-read-?-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        with closing(RunStore(folder)) as store:
            start(store, "SAT-0001")
        yield folder


def as_another(read: Callable[[], list[str]]) -> list[str]:
    """What another user reads, or the fault that they meet."""
    ours, theirs = multiprocessing.get_context("fork").Pipe()

    def work() -> None:
        os.setgroups([])
        os.setuid(NOBODY)
        try:
            theirs.send(read())
        except RecordsError as fault:
            theirs.send([str(fault)])

    process = multiprocessing.get_context("fork").Process(target=work)
    process.start()
    found: list[str] = ours.recv() if ours.poll(20.0) else ["nothing"]
    process.join()
    return found


def by_list(folder: Path) -> list[str]:
    return [run.head.serial for run in listed_runs(folder, 10)]


def by_store(folder: Path) -> list[str]:
    with closing(RunStore(folder, create=False)) as store:
        return [head.serial for head in store.runs()]


@pytest.mark.parametrize("read", [by_list, by_store])
def test_runs_are_read_while_a_daemon_writes_and_after_its_end(
    folder: Path, read: Callable[[Path], list[str]]
) -> None:
    with closing(RunStore(folder)) as store:
        start(store, "SAT-0002")
        assert as_another(lambda: read(folder)) == ["SAT-0002", "SAT-0001"]
    assert not list(folder.glob("*-wal"))
    assert as_another(lambda: read(folder)) == ["SAT-0002", "SAT-0001"]


def test_nothing_is_written_by_a_reader(folder: Path) -> None:
    def write() -> list[str]:
        with closing(RunStore(folder, create=False)) as store:
            start(store, "SAT-0009")
        return ["written"]

    assert "written" not in as_another(write)
    assert by_list(folder) == ["SAT-0001"]


def test_a_daemon_that_starts_in_the_middle_of_a_read_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as another:
        another.setattr(os, "access", lambda _path, _mode: False)
        access = ReadAccess(folder / FILE)
    access.check()
    with closing(RunStore(folder)) as store:
        start(store, "SAT-0002")
        with pytest.raises(StoreUnavailable, match="ask again"):
            access.check()
