"""Older stores are brought to the schema of today when they are opened.

A migration only adds tables and columns. What has been sealed stays as it is (``schema_1``). A
store that holds what its version could not have is refused (``claimed_version``).
"""

import os
import sqlite3
from collections.abc import Callable
from contextlib import closing
from functools import cache
from pathlib import Path

from sqlalchemy import Connection, Index, text
from sqlalchemy.dialects import sqlite as sqlite_dialect
from sqlalchemy.orm import Session
from sqlalchemy.schema import CreateIndex, CreateTable, ExecutableDDLElement

from cellctl.clock import utc_now
from cellctl.errors.records.store import StoreTooNew
from cellctl.files.atomic_files import sync_folder
from cellctl.records.database.claimed_version import require_claimed
from cellctl.records.database.schema import Base, DocumentRow, LedgerRow
from cellctl.records.database.schema_1.tables import PROCESS
from cellctl.records.database.schema_version import SCHEMA_VERSION
from cellctl.records.database.sealing.ledger import seal_unsealed
from cellctl.records.database.sealing.sealed import SEALED_FROM_3_ON


def bring_up_to_date(connection: Connection, file: Path) -> None:
    """Create the tables of a new store, or migrate those of an older one.

    Called inside a transaction that holds the write lock; nothing is changed when it is rolled
    back. Before an older store is changed, its copy is on the disk as ``backup_of(file, version)``.
    Raises ``StoreTooNew``, ``StoreContradictsVersion``, ``OSError`` or ``sqlite3.Error``.
    """
    version = schema_version(connection)
    # Never opened by guessing: a later version may mean other things by the same columns.
    if version > SCHEMA_VERSION:
        raise StoreTooNew(f"{file} has schema {version}, this version knows {SCHEMA_VERSION}")
    if version == SCHEMA_VERSION:
        return
    require_claimed(connection, file, version)
    if version == 0:
        _create_missing(connection)
    else:
        # Before the first change, so that a step that goes wrong costs no run.
        _back_up(file, backup_of(file, version))
        for step in _STEPS[version - 1 :]:
            step(connection)
    connection.execute(text(f"PRAGMA user_version = {SCHEMA_VERSION}"))


def schema_version(connection: Connection) -> int:
    """0 in a file without tables."""
    return int(connection.execute(text("PRAGMA user_version")).scalar_one())


def _create_missing(connection: Connection) -> None:
    """The tables and indexes of today that are not there."""
    for statement in _statements_of_today():
        connection.exec_driver_sql(statement)


@cache
def _statements_of_today() -> tuple[str, ...]:
    # Written once: `create_all` takes ten milliseconds for each store to look for each table and to
    # put the same words together.
    dialect = sqlite_dialect.dialect()
    tables = Base.metadata.sorted_tables
    indexes = (index for table in tables for index in sorted(table.indexes, key=_name_of))
    makings: tuple[ExecutableDDLElement, ...] = (
        *(CreateTable(table, if_not_exists=True) for table in tables),
        *(CreateIndex(index, if_not_exists=True) for index in indexes),
    )
    return tuple(str(making.compile(dialect=dialect)) for making in makings)


def _name_of(index: Index) -> str:
    return str(index.name)


def backup_of(file: Path, version: int) -> Path:
    """Path of the copy that is made of a store before it is migrated from this version."""
    return file.with_name(f"{file.stem}-schema-{version}.sqlite")


def _back_up(file: Path, target: Path) -> None:
    """A copy of the whole database, also of what is still in its write-ahead log.

    Copying the file would miss that log; SQLite's own backup reads beside the writer, which holds
    the lock, so that nothing can come in between the copy and the change.
    """
    draft = target.with_name(f"{target.name}.part")
    draft.unlink(missing_ok=True)
    with closing(sqlite3.connect(file)) as source, closing(sqlite3.connect(draft)) as copy:
        source.backup(copy)
        # One file that needs no log beside it can be put back with a plain copy.
        copy.execute("PRAGMA journal_mode = DELETE")
    descriptor = os.open(draft, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
    # Renamed only when it is whole and on the disk: a crash leaves a draft, which is removed next
    # time, and never a backup that is cut off.
    draft.replace(target)
    sync_folder(target.parent)


def _from_1_to_2(connection: Connection) -> None:
    """Runs of any process: the old tables stay, those that every process uses come beside them."""
    for column in (
        f"process VARCHAR NOT NULL DEFAULT '{PROCESS}'",
        "record_schema INTEGER NOT NULL DEFAULT 1",
    ):
        connection.execute(text(f"ALTER TABLE runs ADD COLUMN {column}"))
    _create_missing(connection)


def _from_2_to_3(connection: Connection) -> None:
    """Seals for everything that an auditor asks for, and the head of the chain.

    What schema 1 and 2 did not seal is sealed as it is found: whether somebody has changed it
    before, or added it, nobody can tell. Runs and gauges they did seal, so that one without a seal
    keeps none, and is named by every verification.
    """
    for table, column in (("gauges", "gauge_id VARCHAR"), ("ledger", "name VARCHAR")):
        connection.execute(text(f"ALTER TABLE {table} ADD COLUMN {column}"))
    _create_missing(connection)
    with Session(connection, join_transaction_mode="rollback_only") as session:
        seal_unsealed(session, utc_now(), SEALED_FROM_3_ON)
        session.flush()


def _from_3_to_4(connection: Connection) -> None:
    """The details of a run are sealed as they are written, which needs no column: runs of earlier
    versions stay sealed as they are. An index finds the entries of a run among so many more."""
    for table in (LedgerRow, DocumentRow):
        for index in table.__table__.indexes:  # type: ignore[attr-defined]  # a Table
            index.create(connection, checkfirst=True)


def _from_4_to_5(connection: Connection) -> None:
    """An index finds what became of a command of the page among years of audit lines."""
    _create_missing(connection)


_STEPS: tuple[Callable[[Connection], None], ...] = (
    _from_1_to_2,
    _from_2_to_3,
    _from_3_to_4,
    _from_4_to_5,
)
"""The first leads from schema 1 to 2."""
