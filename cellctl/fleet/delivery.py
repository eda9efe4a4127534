"""Brings batches of a cell's records into the fleet database, each once and as a whole.

Where the delivery stands is read from the fleet database itself, in the transaction that goes on
from there. A program that is killed, a server that dies or an answer that is lost after the commit
leaves a batch that is there or is not: nothing is lost and nothing comes twice.
"""

from collections.abc import Sequence
from itertools import groupby

from sqlalchemy import Connection, Table, func, select, text, update
from sqlalchemy.dialects.postgresql import insert

from cellctl.clock import utc_now
from cellctl.errors.records.fleet import FleetOutdated, FleetRefused
from cellctl.fleet.cell_records import START, Batch, CellRecords, FilledColumns, NewestValue, NewRow
from cellctl.fleet.database import FleetDatabase
from cellctl.fleet.tables import CellRow, DeliveryRow, table_of
from cellctl.records.database.schema import LedgerHeadRow, LedgerRow
from cellctl.records.database.schema_version import SCHEMA_VERSION
from cellctl.records.seals import LedgerHead

ENTRIES = 200
"""Entries of the ledger in one transaction: some hundred kilobytes, or one run with its figures."""
_ONE = 1


class Delivery:
    """From one cell to the fleet database."""

    def __init__(
        self, cell: str, records: CellRecords, fleet: FleetDatabase, software: str
    ) -> None:
        self._cell = cell
        self._records = records
        self._fleet = fleet
        self._software = software
        self._place: str | None = None

    def deliver(self, limit: int = ENTRIES) -> int:
        """One batch; how many entries of the cell are still to come.

        Raises the 83x faults, ``StoreUnavailable``; nothing of the batch has been delivered then,
        or all of it.
        """
        place = self._entered()
        with self._fleet.transaction(place) as connection:
            before = _delivered(connection)
        batch = self._records.batch(before, limit)
        if not batch.entries:
            return 0
        with self._fleet.transaction(place) as connection:
            # Another forwarder of the same cell would have to wait here.
            connection.execute(text("SELECT pg_advisory_xact_lock(hashtext(:p))"), {"p": place})
            if _delivered(connection) == before:
                _apply(connection, batch)
                self._note(connection, batch)
        return batch.length - int(batch.entries[-1]["number"])

    def _entered(self) -> str:
        """The place of this cell, asked for once; raises ``FleetRefused``, ``FleetOutdated``."""
        if self._place is None:
            with self._fleet.transaction() as connection:
                query = select(CellRow.place, CellRow.record_schema)
                row = connection.execute(query.where(CellRow.name == self._cell)).one_or_none()
            if row is None:
                raise FleetRefused(f"it takes no records of a cell {self._cell!r}")
            if row.record_schema < SCHEMA_VERSION:
                have = f"tables of schema {row.record_schema}"
                raise FleetOutdated(f"{have}, records of {SCHEMA_VERSION}")
            self._place = row.place
        return self._place

    def _note(self, connection: Connection, batch: Batch) -> None:
        said = {
            "length": batch.length,
            "sent": utc_now(),
            "received": func.now(),
            "software": self._software,
        }
        _upsert(connection, table_of(DeliveryRow), "id", {"id": _ONE} | said)


def _delivered(connection: Connection) -> LedgerHead:
    """The newest entry that is there."""
    query = select(LedgerRow.number, LedgerRow.hash).order_by(LedgerRow.number.desc()).limit(1)
    row = connection.execute(query).one_or_none()
    return START if row is None else LedgerHead(row.number, row.hash)


def _apply(connection: Connection, batch: Batch) -> None:
    # Rows of one table that follow each other go in one journey to the server and back.
    for (kind, table), changes in groupby(batch.changes, lambda one: (type(one), one.table)):
        rows = list(changes)
        if kind is NewRow:
            _insert(connection, table, [dict(one.values) for one in rows])
            continue
        for one in rows:
            if isinstance(one, FilledColumns):
                _fill(connection, one)
            elif isinstance(one, NewestValue):
                _upsert(connection, table, table.primary_key.columns[0].name, dict(one.values))
    _insert(connection, table_of(LedgerRow), [dict(entry) for entry in batch.entries])
    last = batch.entries[-1]
    head = {"id": _ONE, "length": last["number"], "hash": last["hash"]}
    _upsert(connection, table_of(LedgerHeadRow), "id", head)


def _insert(connection: Connection, table: Table, rows: Sequence[dict[str, object]]) -> None:
    # A run is told by its opening and by its alarms; a later one changes nothing.
    connection.execute(insert(table).on_conflict_do_nothing(), rows)


def _fill(connection: Connection, change: FilledColumns) -> None:
    columns = change.table.c
    query = update(change.table).values(**change.values)
    for name, value in change.key.items():
        query = query.where(columns[name] == value)
    connection.execute(query.where(*(columns[name].is_(None) for name in change.values)))


def _upsert(connection: Connection, table: Table, key: str, values: dict[str, object]) -> None:
    query = insert(table).values(**values)
    rest = {name: query.excluded[name] for name in values if name != key}
    connection.execute(query.on_conflict_do_update(index_elements=[key], set_=rest))
