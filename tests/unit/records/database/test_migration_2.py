"""A store of schema 2, as its own code wrote it, opens without loss and gets all of its seals."""

import json
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict
from pathlib import Path

import pytest

from cellctl.errors.records.store import StoreContradictsVersion
from cellctl.records import RunResult, RunStore
from cellctl.records.database.migration import backup_of
from cellctl.records.database.schema import COMMAND_KEY
from tests.unit.records.conftest import start

OLD = Path(__file__).parents[3] / "data" / "store-v2"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    return Path(shutil.copytree(OLD, tmp_path / "old"))


@pytest.fixture
def store(old: Path) -> Iterator[RunStore]:
    store = RunStore(old, create=False)
    yield store
    store.close()


@pytest.mark.parametrize("number", [1, 2, 3])
def test_every_run_is_as_it_was(store: RunStore, number: int) -> None:
    expected = json.loads((OLD / "expected.json").read_text(encoding="utf-8"))[number - 1]
    found = json.loads(json.dumps(asdict(store.run(number)), default=str))
    for gauge in found["gauges"]:
        assert gauge.pop("gauge_id") is None
    for name, value in expected.items():
        assert found[name] == value, name


def test_what_had_no_seal_gets_one(store: RunStore, old: Path) -> None:
    assert store.verify() == []
    assert store.ledger_head().length > 4
    assert backup_of(old / "store.sqlite", 2).exists()
    for statement in (
        "UPDATE audit SET actor = 'x' WHERE id = 1",
        "UPDATE alarms SET text = 'x' WHERE id = 2",
        "UPDATE calibrations SET valid_until = '2099-01-01 00:00:00.000000'",
        "UPDATE gauges SET gauge_id = 'PG-1'",
    ):
        before = store.verify()
        with sqlite3.connect(old / "store.sqlite") as connection:
            connection.execute(statement)
        connection.close()
        assert len(store.verify()) > len(before), statement


def test_the_open_run_of_before_is_closed(store: RunStore) -> None:
    assert store.mark_interrupted() == [3]
    assert store.verify() == []


def execute(folder: Path, *statements: str) -> None:
    with closing(sqlite3.connect(folder / "store.sqlite")) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()


FORGED = """
INSERT INTO runs
SELECT 99, process, 'FORGED', recipe_id, recipe_name, recipe_hash, mode, operator, software,
config_hash, simulated, calibration_ids, started, ended, result, fault_number, fault, record_schema
FROM runs WHERE number = 1
"""
AS_2 = (
    "UPDATE runs SET record_schema = 2",
    "ALTER TABLE gauges DROP COLUMN gauge_id",
    "ALTER TABLE ledger DROP COLUMN name",
    "DROP TABLE ledger_head",
)
"""What makes a store of schema 3 look like one of schema 2, but for its ledger."""


@pytest.fixture
def of_today(tmp_path: Path) -> Path:
    store = RunStore(tmp_path / "today")
    run = start(store)
    store.add_alarm(run, 202, "F202")
    store.begin_phase(run, 10, "measure frame")
    store.close_run(run, RunResult.GOOD)
    store.close()
    return store.path


@pytest.mark.parametrize("claimed", [0, 1, 2])
def test_a_store_of_today_that_claims_an_earlier_schema_is_refused(
    of_today: Path, claimed: int
) -> None:
    execute(of_today, f"PRAGMA user_version = {claimed}", FORGED)
    with pytest.raises(StoreContradictsVersion, match=r"ledger_head\.length"):
        RunStore(of_today)
    with closing(sqlite3.connect(of_today / "store.sqlite")) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (claimed,)
        assert connection.execute("SELECT * FROM ledger WHERE subject = 99").fetchone() is None


def test_kinds_that_the_claimed_schema_could_not_have_are_named(of_today: Path) -> None:
    execute(of_today, "PRAGMA user_version = 2", FORGED, *AS_2)
    with pytest.raises(
        StoreContradictsVersion, match="kind alarm, ledger entries of the kind open"
    ):
        RunStore(of_today)


def test_a_run_of_a_later_schema_is_named(old: Path) -> None:
    execute(old, "UPDATE runs SET record_schema = 3 WHERE number = 2")
    with pytest.raises(StoreContradictsVersion, match="run 2 of a later schema"):
        RunStore(old)


def test_a_run_that_was_forged_into_an_old_store_gets_no_seal(old: Path) -> None:
    execute(old, FORGED)
    store = RunStore(old)
    assert store.verify() == ["run 99 is closed but not sealed"]
    store.close()


def test_a_gauge_that_was_forged_into_an_old_store_gets_no_seal(old: Path) -> None:
    execute(
        old,
        "INSERT INTO gauges SELECT 99, run, time, hole, 6.0, source FROM gauges WHERE id = 1",
    )
    store = RunStore(old)
    assert store.verify() == ["gauge 99 is not sealed"]
    store.close()


def test_a_store_of_today_that_claims_schema_3_is_refused(of_today: Path) -> None:
    execute(of_today, "PRAGMA user_version = 3")
    with pytest.raises(StoreContradictsVersion, match="run 1 of a later schema"):
        RunStore(of_today)
    execute(of_today, "UPDATE runs SET record_schema = 3")
    with pytest.raises(StoreContradictsVersion, match="ledger entries of the kind progress"):
        RunStore(of_today)


def test_a_store_of_schema_4_gets_the_index_of_commands(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    store.audit("page:anna@panel-1", "hold", {"key": "press-0001"})
    store.close()
    execute(tmp_path, "DROP INDEX ix_audit_command_key", "PRAGMA user_version = 4")
    store = RunStore(tmp_path)
    store.audit("page:anna@panel-1", "stop", {"key": "press-0002"})
    store.audit("OP-7", "reset")
    for key, action in (("press-0001", "hold"), ("press-0002", "stop")):
        assert [entry.action for entry in store.audit_of_command(key)] == [action]
    assert store.verify() == []
    store.close()
    assert backup_of(tmp_path / "store.sqlite", 4).exists()
    assert used_for_a_command(tmp_path)


def test_the_key_of_a_command_is_looked_up_and_not_searched(of_today: Path) -> None:
    assert used_for_a_command(of_today)


def used_for_a_command(folder: Path) -> bool:
    asked = f"EXPLAIN QUERY PLAN SELECT * FROM audit WHERE {COMMAND_KEY} = 'x' ORDER BY audit.id"
    with closing(sqlite3.connect(folder / "store.sqlite")) as connection:
        plan = " ".join(str(row) for row in connection.execute(asked))
    return "USING INDEX ix_audit_command_key" in plan
