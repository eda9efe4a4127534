"""Two versions never share one store: neither two daemons nor a daemon and a command."""

import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from cellctl.errors.records.store import StoreHeldByEarlierVersion, StoreInUse, StoreTooNew
from cellctl.records import RunStore
from cellctl.records.database.schema_version import SCHEMA_VERSION
from cellctl.records.run_list import listed_runs
from tests.unit.records.conftest import start

OLD = Path(__file__).parents[2] / "data" / "store-v2"
OWNER = """
import fcntl, sys
lock = open(sys.argv[1], "w")
fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
print("owned", flush=True)
sys.stdin.read()
"""
"""What every version of the daemon does with the store that it works on."""


@pytest.fixture
def old(tmp_path: Path) -> Path:
    return Path(shutil.copytree(OLD, tmp_path / "store"))


@pytest.fixture
def old_daemon(old: Path) -> Iterator[None]:
    command = [sys.executable, "-c", OWNER, str(old / "owner.lock")]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as daemon:
        assert daemon.stdout is not None
        assert daemon.stdout.readline() == "owned\n"
        yield
        daemon.communicate()


def version(folder: Path) -> int:
    with closing(sqlite3.connect(folder / "store.sqlite")) as connection:
        return int(connection.execute("PRAGMA user_version").fetchone()[0])


@pytest.mark.usefixtures("old_daemon")
def test_nothing_migrates_the_store_of_a_daemon_that_runs(old: Path) -> None:
    with pytest.raises(StoreHeldByEarlierVersion):
        RunStore(old)
    with pytest.raises(StoreHeldByEarlierVersion):
        listed_runs(old, 5)
    assert version(old) == 2
    assert not list(old.glob("*schema-2*"))


def test_the_store_of_a_daemon_that_has_ended_is_migrated(old: Path) -> None:
    first = RunStore(old)
    assert version(old) == SCHEMA_VERSION
    # The lock of the migration is not kept: another one may become the owner.
    second = RunStore(old)
    second.mark_interrupted()
    with pytest.raises(StoreInUse):
        first.mark_interrupted()
    first.close()
    second.close()


def test_a_program_that_was_overtaken_by_an_upgrade_writes_nothing_more(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    run = start(store)
    with closing(sqlite3.connect(tmp_path / "store.sqlite")) as later:
        later.execute(f"PRAGMA user_version = {SCHEMA_VERSION + 1}")
        later.commit()
    for write in (
        lambda: store.audit("OP-7", "note"),
        lambda: start(store),
        lambda: store.set_gauge(run, "P1", 5.95, "OP-7"),
    ):
        with pytest.raises(StoreTooNew, match="since it was opened"):
            write()
    store.close()
    with closing(sqlite3.connect(tmp_path / "store.sqlite")) as connection:
        assert connection.execute("SELECT count(*) FROM audit").fetchone() == (0,)
        assert connection.execute("SELECT count(*) FROM runs").fetchone() == (1,)
    with pytest.raises(StoreTooNew):
        RunStore(tmp_path)
