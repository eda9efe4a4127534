"""Every record of a cell arrives once, unchanged, in its order, whatever fails on the way."""

import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import asdict
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.clock import utc_now
from cellctl.errors.records.fleet import (
    FleetDiffers,
    FleetOutdated,
    FleetRefused,
    RecordUndeliverable,
)
from cellctl.errors.records.store import StoreTooNew, StoreUnavailable
from cellctl.fleet import recall
from cellctl.records import RunResult, RunStore
from cellctl.records.database.schema_version import SCHEMA_VERSION
from cellctl.records.figures import figure
from cellctl.records.run_filter import RunFilter
from tests.rigs.sweeps import sweep
from tests.unit.fleet.conftest import NORTH, SOUTH, Fleet, deliver_all
from tests.unit.records.conftest import start
from tests.unit.records.sample import good_run

DATA = Path(__file__).parents[2] / "data"


def assert_whole(fleet: Fleet, cell: str, store: RunStore) -> None:
    """What the fleet has of a cell is what the cell's store has, and can be verified there."""
    (there,) = recall.cells(fleet.owner, cell)
    assert there.head == store.ledger_head()
    assert there.still_to_come == 0
    assert recall.problems(fleet.owner, cell, store.ledger_head()) == []
    for head in store.runs(limit=1000):
        record, audit = recall.run(fleet.owner, cell, head.number)
        assert asdict(record) == asdict(store.run(head.number))
        assert audit == store.audit_log()


def everything(store: RunStore) -> None:
    """Rows of every table, those that are filled later included."""
    run = good_run(store)
    alarm = store.add_alarm(run, 207, "F207 late")
    store.add_alarm(None, 801, "F801 the disk")
    store.acknowledge_alarms(801, "OP-7")
    store.audit("OP-7", "note", {"text": "größer als 2³¹: ", "number": 2**40})
    for seq in (7, 8, 65535):
        store.note_line_seq(seq)
    aborted = start(store, "SAT-\u00fc%_'")
    store.close_run(aborted, RunResult.ABORTED, fault_number=304, fault="F304 it did not stop")
    start(store, "SAT-0003")
    assert alarm


@pytest.mark.parametrize("limit", sweep((1, 3, 200), (3,)))
def test_every_record_arrives(fleet: Fleet, limit: int) -> None:
    store = fleet.store(NORTH)
    everything(store)
    deliver_all(fleet.delivery(NORTH), limit)
    assert_whole(fleet, NORTH, store)


def test_the_copy_can_be_verified_after_every_batch(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    delivery = fleet.delivery(NORTH)
    left = 1
    while left:
        left = delivery.deliver(1)
        (cell,) = recall.cells(fleet.owner, NORTH)
        assert cell.still_to_come == left
        assert recall.problems(fleet.owner, NORTH) == [], cell.head.length


def test_what_comes_later_is_brought_later(fleet: Fleet) -> None:
    store, delivery = fleet.store(NORTH), fleet.delivery(NORTH)
    run = start(store)
    assert delivery.deliver() == 0
    record, _ = recall.run(fleet.owner, NORTH, run)
    assert record.head.ended is None
    store.close_run(run, RunResult.GOOD)
    store.add_alarm(run, 207, "late")
    delivery.deliver()
    store.acknowledge_alarms(207, "OP-7")
    store.note_line_seq(5)
    delivery.deliver()
    assert_whole(fleet, NORTH, store)


def test_delivering_again_changes_nothing(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    deliver_all(fleet.delivery(NORTH))
    before = recall.cells(fleet.owner, NORTH)[0].received
    deliver_all(fleet.delivery(NORTH))
    assert recall.cells(fleet.owner, NORTH)[0].received == before
    assert_whole(fleet, NORTH, store)


def test_two_forwarders_of_one_cell_bring_each_row_once(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    one, other = fleet.delivery(NORTH), fleet.delivery(NORTH)
    while one.deliver(2) + other.deliver(3):
        pass
    assert_whole(fleet, NORTH, store)


def test_cells_are_kept_apart(fleet: Fleet) -> None:
    north, south = fleet.store(NORTH), fleet.store(SOUTH)
    everything(north)
    everything(south)
    south.note_line_seq(9)
    for cell in (NORTH, SOUTH):
        deliver_all(fleet.delivery(cell))
    assert_whole(fleet, NORTH, north)
    assert_whole(fleet, SOUTH, south)


@pytest.mark.parametrize("name", sweep(("store-v1", "store-v2"), ("store-v2",)))
def test_records_of_earlier_versions_arrive(fleet: Fleet, name: str) -> None:
    folder = fleet.folder(NORTH)
    shutil.copytree(DATA / name, folder, ignore=shutil.ignore_patterns("expected*"))
    delivery = fleet.delivery(NORTH)
    with pytest.raises(StoreUnavailable, match="not yet"):
        delivery.deliver()
    store = fleet.store(NORTH)  # as the daemon does, which migrates it
    deliver_all(delivery, 2)
    # A run that is open now comes when it ends: earlier versions have sealed no openings.
    assert recall.problems(fleet.owner, NORTH, store.ledger_head()) == []
    assert store.mark_interrupted()
    deliver_all(delivery, 1)
    assert_whole(fleet, NORTH, store)


def test_a_store_of_a_later_version_is_left_alone(fleet: Fleet) -> None:
    fleet.store(NORTH).close()
    with sqlite3.connect(fleet.folder(NORTH) / "store.sqlite") as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(StoreTooNew):
        fleet.delivery(NORTH).deliver()


def test_the_store_is_only_read(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    store.close()
    before = (fleet.folder(NORTH) / "store.sqlite").read_bytes()
    deliver_all(fleet.delivery(NORTH))
    assert (fleet.folder(NORTH) / "store.sqlite").read_bytes() == before


def another_store(fleet: Fleet) -> None:
    """The store of the cell is replaced by one with another history."""
    shutil.rmtree(fleet.folder(NORTH))
    store = RunStore(fleet.folder(NORTH))
    everything(store)
    everything(store)
    store.close()


def backup_put_back(fleet: Fleet) -> None:
    """Put a backup back as after a broken disk: the newest records of the cell are gone."""
    with sqlite3.connect(fleet.folder(NORTH) / "store.sqlite") as connection:
        connection.execute("DELETE FROM ledger WHERE number > 5")
    connection.close()


def spoilt_there(fleet: Fleet) -> None:
    fleet.execute(
        f"UPDATE {fleet.places[NORTH]}.ledger SET hash = repeat('0', 64)"
        f" WHERE number = (SELECT max(number) FROM {fleet.places[NORTH]}.ledger)"
    )


@pytest.mark.parametrize(
    "happens", sweep((another_store, backup_put_back, spoilt_there), (backup_put_back,))
)
def test_two_histories_are_not_mixed(fleet: Fleet, happens: Callable[[Fleet], None]) -> None:
    store = fleet.store(NORTH)
    everything(store)
    deliver_all(fleet.delivery(NORTH))
    store.close()
    happens(fleet)
    with pytest.raises(FleetDiffers):
        fleet.delivery(NORTH).deliver()


def test_an_unknown_cell_is_refused_until_it_is_added(fleet: Fleet) -> None:
    everything(fleet.store(NORTH))
    fleet.execute(f"UPDATE fleet.cells SET name = 'another' WHERE name = '{NORTH}'")
    delivery = fleet.delivery(NORTH)
    with pytest.raises(FleetRefused, match=NORTH):
        delivery.deliver()
    fleet.execute(f"UPDATE fleet.cells SET name = '{NORTH}' WHERE name = 'another'")
    deliver_all(delivery)


def test_an_open_run_is_no_problem_of_the_copy_and_no_change_of_its_row(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    run = start(store)
    store.begin_phase(run, 10, "measure frame")
    store.add(run, figure("force", 36.0, "N"))
    delivery = fleet.delivery(NORTH)
    deliver_all(delivery)
    assert recall.problems(fleet.owner, NORTH, store.ledger_head()) == []
    store.add(run, figure("offset", 0.1, "mm"))
    store.close_run(run, RunResult.GOOD)
    deliver_all(delivery)
    assert_whole(fleet, NORTH, store)


def test_older_tables_are_waited_for(fleet: Fleet) -> None:
    everything(fleet.store(NORTH))
    fleet.execute("UPDATE fleet.cells SET record_schema = 2")
    delivery = fleet.delivery(NORTH)
    with pytest.raises(FleetOutdated):
        delivery.deliver()
    fleet.execute(f"UPDATE fleet.cells SET record_schema = {SCHEMA_VERSION}")
    deliver_all(delivery)


def test_a_text_that_postgresql_refuses_is_named(fleet: Fleet) -> None:
    store = fleet.store(NORTH)
    everything(store)
    store.add_alarm(None, 207, "a zero\x00 byte")
    with pytest.raises(RecordUndeliverable):
        deliver_all(fleet.delivery(NORTH), 1)
    (cell,) = recall.cells(fleet.owner, NORTH)
    assert cell.still_to_come == 1
    assert recall.problems(fleet.owner, NORTH) == []


def test_clocks_that_differ_disorder_nothing_of_a_cell(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Order comes from the ledger; whose clock is wrong is said."""
    store, delivery = fleet.store(NORTH), fleet.delivery(NORTH)
    everything(store)
    for module in ("store", "database.rows"):
        monkeypatch.setattr(
            f"cellctl.records.{module}.utc_now", lambda: utc_now() - timedelta(days=400)
        )
    store.close_run(start(store, "SAT-BEFORE"), RunResult.GOOD)
    monkeypatch.setattr("cellctl.fleet.delivery.utc_now", lambda: utc_now() - timedelta(hours=2))
    deliver_all(delivery)
    assert_whole(fleet, NORTH, store)
    (cell,) = recall.cells(fleet.owner, NORTH)
    assert cell.clock_ahead_s == pytest.approx(-7200, abs=60)
    found = recall.runs(fleet.owner, RunFilter(serial="SAT-BEFORE"), 5)
    assert [one.run.head.serial for one in found] == ["SAT-BEFORE"]
