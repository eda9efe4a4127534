"""The list of runs says what the store says, without the store's layers."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from cellctl.errors.records.store import StoreTooNew, StoreUnavailable
from cellctl.records import RunResult, RunStore
from cellctl.records.database.schema_version import FILE
from cellctl.records.entered.gauges import GAUGE_HOLES, part_verdict
from cellctl.records.entries import Document
from cellctl.records.run_filter import RunFilter
from cellctl.records.run_list import listed_runs
from tests.unit.records.conftest import start
from tests.unit.records.sample import good_run


@pytest.fixture
def filled(store: RunStore) -> RunStore:
    """A good run, one with a fault, one of another serial number that is open."""
    good_run(store)
    bad = start(store, "SAT-0042")
    store.close_run(bad, RunResult.ABORTED, fault_number=304, fault="F304 it did not stop")
    start(store, "SAT-0043")
    return store


def with_gauge(store: RunStore, *diameters_mm: float) -> int:
    """A good run with a hole of at least 5.80 mm, and its gauges in this order."""
    run = start(store)
    store.add(run, Document(GAUGE_HOLES, {"P1": {"least_mm": 5.8, "most_mm": 6.0}}))
    store.close_run(run, RunResult.GOOD)
    for diameter_mm in diameters_mm:
        store.set_gauge(run, "P1", diameter_mm, "anna")
    return run


@pytest.mark.parametrize(("limit", "serial"), [(9, ""), (2, ""), (9, "SAT-0042"), (9, "?")])
def test_heads_are_those_of_the_store(filled: RunStore, limit: int, serial: str) -> None:
    found = [one.head for one in listed_runs(filled.path, limit, RunFilter(serial=serial))]
    assert found == filled.runs(limit, serial or None)


@pytest.mark.parametrize("diameters_mm", [(), (5.95,), (5.70,), (5.70, 5.95), (5.95, 5.70)])
def test_a_gauge_spoils_what_it_spoils_in_the_report(
    store: RunStore, diameters_mm: tuple[float, ...]
) -> None:
    run = with_gauge(store, *diameters_mm)
    (found,) = listed_runs(store.path, 9)
    assert found.spoilt == (part_verdict(store.run(run)) == RunResult.BAD)
    assert found.spoilt == (bool(diameters_mm) and diameters_mm[-1] < 5.8)
    assert found.for_programs()["part_verdict"] == part_verdict(store.run(run))


def test_where_there_is_no_store_none_is_made(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="there is no"):
        listed_runs(tmp_path, 9)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_database_is_named(tmp_path: Path) -> None:
    (tmp_path / FILE).write_bytes(b"no database, but long enough to be read as one" * 99)
    with pytest.raises(StoreUnavailable, match=FILE):
        listed_runs(tmp_path, 9)


def test_a_store_of_a_later_version_is_left_alone(filled: RunStore) -> None:
    filled.close()
    with closing(sqlite3.connect(filled.path / FILE)) as connection:
        connection.execute("PRAGMA user_version = 99")
    with pytest.raises(StoreTooNew):
        listed_runs(filled.path, 9)
