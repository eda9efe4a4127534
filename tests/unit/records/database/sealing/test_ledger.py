"""Whatever is changed in a store, one column, one row or one bit of a file at a time, is found."""

import shutil
import sqlite3
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Column, text
from sqlalchemy.orm import Session

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.errors.records.store import StoreContradictsVersion
from cellctl.records import RunResult, RunStore
from cellctl.records.database.schema import Base
from cellctl.records.database.sealing import ledger
from cellctl.records.figures import Limit, figure
from cellctl.records.seals import LedgerHead
from tests.unit.records import sample
from tests.unit.records.conftest import start

TABLES = Base.metadata.sorted_tables
NAMES = [table.name for table in TABLES]
COLUMNS = [(table.name, column.name) for table in TABLES for column in table.columns]
LAST = dict(COLUMNS)
"""The last column of each table."""


@pytest.fixture(scope="module")
def sealed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with a row in every table and a value in every column."""
    folder = tmp_path_factory.mktemp("sealed") / "store"
    store = RunStore(folder)
    now = datetime.now(UTC)
    stored = StoredCalibration(
        "payload", {"verdict": "pass"}, now, now + timedelta(days=1), "cellctl", "S-1"
    )
    store.add_calibration(stored)
    store.invalidate_calibration(stored, "collision")
    sample.good_run(store)
    bad = start(store, "SAT-0002")
    store.begin_phase(bad, 10, "measure frame")
    store.add_alarm(bad, 525, "F525 Side load too high while mating")
    store.close_run(bad, RunResult.BAD, fault_number=525, fault="F525")
    store.acknowledge_alarms(525, "OP-7")
    store.add_alarm(None, 202, "F202 lost")
    store.set_gauge(bad, "P1", 5.91, "OP-7", "PG-17")
    store.note_line_seq(40)
    store.note_line_seq(41)
    store.audit("OP-7", "start", {"run": 1})
    assert store.verify() == []
    store.close()
    return folder


@pytest.fixture
def copy(sealed: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(sealed, tmp_path / "store"))


def problems(folder: Path) -> list[str]:
    store = RunStore(folder, create=False)
    try:
        return store.verify()
    finally:
        store.close()


def execute(folder: Path, statement: str, *values: Any) -> int:
    with sqlite3.connect(folder / "store.sqlite") as connection:
        connection.execute("PRAGMA foreign_keys = OFF")
        changed = connection.execute(statement, values).rowcount
    connection.close()
    return changed


def newest(table: str) -> str:
    return f"rowid = (SELECT max(rowid) FROM {table})"


@pytest.fixture(scope="module")
def whole(sealed: Path) -> Iterator[RunStore]:
    """The same store open: changes are made in a transaction that is rolled back."""
    store = RunStore(sealed, create=False)
    yield store
    store.close()


def found_after(store: RunStore, statement: str, **values: Any) -> list[str]:
    """What verification says after a statement that changes one row; the store stays as it is."""
    with Session(store._database._engine) as session:
        session.connection().exec_driver_sql("PRAGMA defer_foreign_keys = ON")
        result = session.connection().execute(text(statement), values)
        assert result.rowcount == 1
        found = list(ledger.problems(session))
        session.rollback()
    return found


def another(column: Column[Any], value: Any) -> Any:
    """A value of the same form that is not the same."""
    if isinstance(value, str) and value[:2] == "20":
        return value.replace("20", "19", 1)
    if isinstance(value, str) and value[:1] in ("{", "["):
        return {"{": '{"x": 1}', "[": "[]"}[value[0]] if value != '{"x": 1}' else "{}"
    if isinstance(value, str):
        known = {"fail": "pass", "pass": "fail", "measured": "reported"}
        return known.get(value, f"{value[:-1]}x")
    if isinstance(value, int | float):
        boolean = "BOOL" in str(column.type).upper()
        return 1 - value if boolean else value + 1
    return 7 if "INT" in str(column.type).upper() else "2020-01-01 00:00:00.000000"


@pytest.mark.parametrize(
    ("table", "column"),
    [
        pytest.param(*one, marks=() if one in LAST.items() else pytest.mark.figures)
        for one in COLUMNS
    ],
)
def test_every_column_of_the_newest_row(whole: RunStore, table: str, column: str) -> None:
    described = Base.metadata.tables[table].columns[column]
    with whole._database.read() as session:
        query = f"SELECT {column} FROM {table} WHERE {newest(table)}"
        value = session.connection().exec_driver_sql(query).scalar_one()
    changed = another(described, value)
    assert changed != value
    statement = f"UPDATE {table} SET {column} = :changed WHERE {newest(table)}"
    assert found_after(whole, statement, changed=changed)


@pytest.mark.parametrize("table", NAMES)
def test_the_newest_row_of_every_table(whole: RunStore, table: str) -> None:
    assert found_after(whole, f"DELETE FROM {table} WHERE {newest(table)}")


@pytest.mark.parametrize("table", [name for name in NAMES if name != "ledger_head"])
def test_a_row_that_nobody_has_sealed(whole: RunStore, table: str) -> None:
    """A copy of the newest row under a new number or name."""
    columns = Base.metadata.tables[table].columns
    fresh = {column.name: column.name for column in columns}
    for column in columns:
        if column.primary_key:
            named = column.type.python_type is str
            fresh[column.name] = f"'{'f' * 64}'" if named else "NULL"
    if table == "ledger":
        fresh["hash"] = f"'{'e' * 64}'"
    source = f"SELECT {', '.join(fresh.values())} FROM {table} WHERE {newest(table)}"
    assert found_after(whole, f"INSERT INTO {table} ({', '.join(fresh)}) {source}")


@pytest.mark.parametrize(
    ("record_schema", "process", "ended"),
    [
        pytest.param("2", "process", "NULL", id="open, of a schema that sealed no openings"),
        pytest.param("1", "process", "ended", id="closed, of a schema whose tables are not there"),
        pytest.param("1", "'other'", "ended", id="closed, of a process that schema 1 did not know"),
    ],
)
def test_a_good_run_that_claims_to_be_older_than_its_seals(
    copy: Path, record_schema: str, process: str, ended: str
) -> None:
    store = RunStore(copy, create=False)
    before = store.good_parts()
    store.close()
    forged = {"number": "99", "record_schema": record_schema, "process": process, "ended": ended}
    names = [column.name for column in Base.metadata.tables["runs"].columns]
    values = ", ".join(forged.get(name, name) for name in names)
    execute(
        copy,
        f"INSERT INTO runs ({', '.join(names)}) SELECT {values} FROM runs WHERE result = 'good'",
    )
    store = RunStore(copy, create=False)
    assert store.good_parts() == before + 1
    assert store.verify() == ["run 99 is closed but not sealed"]
    store.close()


_PLANTED = (
    "CREATE TRIGGER planted AFTER INSERT ON figures"
    " BEGIN UPDATE figures SET value = 0.01, verdict = 'pass' WHERE id = new.id; END"
)


def test_a_trigger_that_changes_figures_before_they_are_sealed(copy: Path) -> None:
    """What it changes is read back, judged and sealed, so that nothing is written beside it."""
    store = RunStore(copy)
    run = start(store, "SAT-0003")
    execute(copy, _PLANTED)
    assert store.verify() == ["the store has trigger planted"]
    with pytest.raises(StoreContradictsVersion, match="trigger planted"):
        store.add(run, figure("offset", 3.0, "mm", limit=Limit(upper=0.2)))
    with pytest.raises(StoreContradictsVersion, match="trigger planted"):
        store.close_run(run, RunResult.GOOD)
    execute(copy, "DROP TRIGGER planted")
    assert store.run(run).figures == ()
    assert store.run(run).head.result is None
    store.close()


_UNWRITTEN = (
    "ALTER TABLE figures RENAME TO before",
    "CREATE TABLE figures ({columns}, beyond INT GENERATED ALWAYS AS"
    " (CASE verdict WHEN 'fail' THEN 1 END) STORED UNIQUE ON CONFLICT IGNORE{references})",
    "DROP TABLE before",
    "INSERT INTO figures (id, run, key, label, unit, time, verdict)"
    " VALUES (-1, -1, '', '', '', '2026-01-01 00:00:00.000000', 'fail')",
)


def test_a_table_that_drops_figures_beyond_their_limits(copy: Path) -> None:
    """Nobody is told that the row was not written, and the rest is judged and sealed."""
    store = RunStore(copy)
    run = start(store, "SAT-0003")
    with sqlite3.connect(copy / "store.sqlite") as database:
        (made,) = database.execute(
            "SELECT sql FROM sqlite_master WHERE name = 'figures'"
        ).fetchone()
    columns, _, keys = made.partition("(")[2].partition("PRIMARY KEY")
    for statement in _UNWRITTEN:
        execute(
            copy,
            statement.format(
                columns=columns.strip().rstrip(","), references=f", PRIMARY KEY{keys[:-1]}"
            ),
        )
    assert "the store has table figures with GENERATED" in store.verify()
    with pytest.raises(StoreContradictsVersion, match="table figures"):
        store.add(run, figure("offset", 3.0, "mm", limit=Limit(upper=0.2)))
    with pytest.raises(StoreContradictsVersion, match="table figures"):
        store.close_run(run, RunResult.GOOD)
    store.close()


def test_a_view_in_place_of_a_table(copy: Path) -> None:
    execute(copy, "ALTER TABLE gauges RENAME TO kept")
    execute(copy, "CREATE VIEW gauges AS SELECT * FROM kept")
    assert "the store has view gauges" in problems(copy)


def test_a_run_that_is_removed_with_its_seals(copy: Path) -> None:
    """Nothing of it is left, and its number would be given again."""
    for table in ("phases", "figures", "poses", "passes", "documents", "artefacts", "gauges"):
        execute(copy, f"DELETE FROM {table} WHERE run = 2")
    execute(copy, "DELETE FROM alarms WHERE run = 2")
    execute(copy, "DELETE FROM runs WHERE number = 2")
    with sqlite3.connect(copy / "store.sqlite") as connection:
        first = connection.execute(
            "SELECT number FROM ledger WHERE kind = 'opening' AND subject = 2"
        ).fetchone()[0]
    connection.close()
    execute(copy, "DELETE FROM ledger WHERE number >= ?", first)
    execute(copy, "DELETE FROM audit")
    execute(copy, "DELETE FROM persistent_values")
    assert any("the ledger's head says" in problem for problem in problems(copy))


def test_a_head_that_was_printed_shows_a_tail_that_was_cut_with_its_head(copy: Path) -> None:
    store = RunStore(copy)
    printed = store.ledger_head()
    store.audit("OP-8", "later")
    assert store.verify(printed) == [], "what came after the report is no problem"
    store.close()
    execute(copy, "DELETE FROM audit")
    execute(copy, "DELETE FROM ledger WHERE kind = 'audit'")
    execute(
        copy,
        "UPDATE ledger_head SET (length, hash) ="
        " (SELECT number, hash FROM ledger ORDER BY number DESC LIMIT 1)",
    )
    assert problems(copy) == [], "nothing in the store tells of it"
    store = RunStore(copy)
    assert store.verify(printed) == [
        f"the head given says {printed.length} entries, the ledger ends at {printed.length - 1}"
    ]
    store.close()


def test_an_open_run_that_is_removed(copy: Path) -> None:
    store = RunStore(copy)
    start(store, "SAT-0003")
    assert store.verify() == []
    store.close()
    execute(copy, "DELETE FROM runs WHERE number = 3")
    assert problems(copy) == ["opening 3 was changed after it was sealed"]


def files(folder: Path) -> Iterator[Path]:
    return (path for path in sorted((folder / "files").rglob("*")) if path.is_file())


def test_a_bit_in_every_file(copy: Path) -> None:
    paths = list(files(copy))
    assert len(paths) >= 2
    for path in paths:
        whole = path.read_bytes()
        for place in (0, len(whole) // 2, len(whole) - 1):
            path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
            store = RunStore(copy, create=False)
            assert any("match its name" in problem for problem in store.verify()), path
            store.close()
        path.write_bytes(whole)


def test_the_head_of_an_empty_store(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    assert store.ledger_head() == LedgerHead(0, "0" * 64)
    assert store.verify() == []
    store.close()
