"""What a cell has recorded since an entry of its ledger, as rows to be delivered.

The ledger is the order of everything that may no longer change, so its newest entry at the other
end says what is still to come: nothing has to be remembered here. A row is brought with the entry
that seals it, and only with the columns that this entry seals, so that the copy can be verified
after every batch.
"""

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, Table, create_engine, func, select, text
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.pool import NullPool

from cellctl.errors.records.fleet import FleetDiffers
from cellctl.errors.records.store import StoreTooNew, StoreUnavailable
from cellctl.fleet.tables import table_of
from cellctl.records.database.schema import LedgerRow, RunRow
from cellctl.records.database.schema_1.tables import (
    IterationOfSchema1,
    MeasurementOfSchema1,
    RunOfSchema1,
)
from cellctl.records.database.schema_version import FILE, SCHEMA_VERSION
from cellctl.records.database.sealing.ledger import GENESIS
from cellctl.records.database.sealing.sealed import (
    ACKNOWLEDGEMENT,
    ALARM,
    CALIBRATION,
    FILLED,
    INVALIDATION,
    KINDS,
    RUN,
)
from cellctl.records.database.sealing.written_details import DETAILS
from cellctl.records.seals import LedgerHead

START = LedgerHead(0, GENESIS)
"""Before the first entry."""
LATER = {ALARM: FILLED[ACKNOWLEDGEMENT], CALIBRATION: FILLED[INVALIDATION]}
"""Columns that an entry of this kind leaves to a later one."""
Values = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class NewRow:
    """A row that is written once."""

    table: Table
    values: Values


@dataclass(frozen=True, slots=True)
class FilledColumns:
    """Columns of a row that were empty until now."""

    table: Table
    key: Values
    """Column and value that name the row."""
    values: Values


@dataclass(frozen=True, slots=True)
class NewestValue:
    """A row whose value is replaced by every later one."""

    table: Table
    values: Values


Change = NewRow | FilledColumns | NewestValue


@dataclass(frozen=True, slots=True)
class Batch:
    """Entries of the ledger that follow each other, with what they seal."""

    after: LedgerHead
    entries: Sequence[Values]
    changes: Sequence[Change]
    length: int
    """Length of the whole ledger of the cell."""


class CellRecords:
    """A cell's run store, beside its daemon. Only read; used from one thread at a time."""

    def __init__(self, folder: Path) -> None:
        self._file = folder / FILE
        self._engine = _reading_engine(self._file)

    def close(self) -> None:
        """Drop the connection."""
        self._engine.dispose()

    def length(self) -> int:
        """Number of the newest entry; raises ``StoreUnavailable``, ``StoreTooNew``."""
        try:
            with self._engine.connect() as connection:
                self._require_version(connection)
                return _length(connection)
        except (SQLAlchemyError, sqlite3.Error) as error:
            raise StoreUnavailable(f"{self._file}: {getattr(error, 'orig', error)}") from error

    def batch(self, after: LedgerHead, limit: int) -> Batch:
        """The entries behind ``after``, the oldest ``limit`` of them.

        Raises ``FleetDiffers`` if this ledger does not hold ``after``, ``StoreUnavailable``.
        """
        try:
            # One transaction: a daemon may write between the queries.
            with self._engine.connect() as connection:
                self._require_version(connection)
                self._require_entry(connection, after)
                query = select(table_of(LedgerRow)).where(LedgerRow.number > after.length)
                found = connection.execute(query.order_by(LedgerRow.number).limit(limit))
                entries = [dict(row._mapping) for row in found]
                changes = [change for entry in entries for change in _changes(connection, entry)]
                return Batch(after, entries, changes, _length(connection))
        except (SQLAlchemyError, sqlite3.Error) as error:
            raise StoreUnavailable(f"{self._file}: {getattr(error, 'orig', error)}") from error

    def _require_version(self, connection: Connection) -> None:
        version = int(connection.execute(text("PRAGMA user_version")).scalar_one())
        if version > SCHEMA_VERSION:
            raise StoreTooNew(f"{self._file} has schema {version}")
        if version < SCHEMA_VERSION:
            # Left to the daemon, which makes a backup before it.
            raise StoreUnavailable(f"{self._file} has schema {version}, not yet {SCHEMA_VERSION}")

    def _require_entry(self, connection: Connection, head: LedgerHead) -> None:
        query = select(LedgerRow.hash).where(LedgerRow.number == head.length)
        found = connection.execute(query).scalar_one_or_none()
        if head != START and found != head.hash:
            what = "another one" if found else "none"
            raise FleetDiffers(f"entry {head.length} of its ledger; {self._file} has {what}")


def _reading_engine(file: Path) -> Engine:
    def connect() -> sqlite3.Connection:
        if not file.exists():
            raise sqlite3.OperationalError(f"there is no {file}")
        # As a URI, in which a question mark or a per cent sign of a folder's name is written so.
        where = f"{file.absolute().as_uri()}?mode=ro"
        connection = sqlite3.connect(where, uri=True, timeout=5.0)
        connection.isolation_level = None
        # A deferred transaction begins with its first query, and keeps what it sees.
        connection.execute("BEGIN")
        return connection

    # No pool: each connection is one transaction, and none that is idle keeps the daemon's log from
    # being put into the database.
    return create_engine("sqlite://", creator=connect, poolclass=NullPool)


def _length(connection: Connection) -> int:
    return connection.execute(select(func.max(LedgerRow.number))).scalar_one() or 0


def _changes(connection: Connection, entry: Values) -> Iterator[Change]:
    """What an entry brings. Nothing where the row is gone: that the copy lacks it, too, shows."""
    name = entry["kind"]
    kind = KINDS.get(name)
    if kind is None:
        return
    key = entry["subject"] if entry["name"] is None else entry["name"]
    table = table_of(kind.table)
    row = _row(connection, table, kind.key, key)
    if row is None:
        return
    # Runs of earlier versions have no entry for their opening.
    run = row["number"] if kind.table is RunRow else row.get("run")
    if run is not None:
        yield from _opened_run(connection, run)
    if name in FILLED:
        if name == RUN:
            yield from _closed_run(connection, row)
        filled = {column: row[column] for column in FILLED[name]}
        yield FilledColumns(table, {kind.key: key}, filled)
    elif kind.table is RunRow:
        return  # the opening is there, and details come with the closing
    elif kind.superseded:
        yield NewestValue(table, row)
    else:
        left = LATER.get(name, frozenset())
        yield NewRow(table, {column: None if column in left else row[column] for column in row})


def _opened_run(connection: Connection, number: int) -> Iterator[Change]:
    """A run as it was when it began."""
    table = table_of(RunRow)
    if (row := _row(connection, table, "number", number)) is not None:
        yield NewRow(table, row | dict.fromkeys(FILLED[RUN]))


def _closed_run(connection: Connection, run: Values) -> Iterator[Change]:
    """The details of a run, and what schema 1 kept elsewhere."""
    number = run["number"]
    tables = [table_of(row) for row in DETAILS]
    if run["record_schema"] == 1:
        tables += [table_of(row) for row in (MeasurementOfSchema1, IterationOfSchema1)]
        old = table_of(RunOfSchema1)
        if (row := _row(connection, old, "number", number)) is not None:
            yield FilledColumns(old, {"number": number}, {"mating": row["mating"]})
    for table in tables:
        query = select(table).where(table.c.run == number).order_by(table.c.id)
        for found in connection.execute(query):
            yield NewRow(table, dict(found._mapping))


def _row(connection: Connection, table: Table, key: str, value: Any) -> dict[str, Any] | None:
    found = connection.execute(select(table).where(table.c[key] == value)).one_or_none()
    return None if found is None else dict(found._mapping)
