"""Searches the records of all cells: which parts are affected, and where they were made."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import bindparam, func, select, text
from sqlalchemy.orm import Session
from sqlalchemy.types import NullType

from cellctl.errors.records.fleet import FleetRefused
from cellctl.fleet.database import FleetDatabase
from cellctl.fleet.tables import CellRow, DeliveryRow
from cellctl.records.database import reading
from cellctl.records.database.rows import to_entry
from cellctl.records.database.schema import GaugeRow, RunRow
from cellctl.records.database.sealing import ledger
from cellctl.records.entered.gauges import part_verdict
from cellctl.records.entries import AuditEntry, RunHead, RunRecord, RunResult
from cellctl.records.run_filter import RunFilter
from cellctl.records.run_list import ListedRun
from cellctl.records.seals import LedgerHead


@dataclass(frozen=True, slots=True)
class FleetCell:
    """A cell, and how far its records have come."""

    name: str
    record_schema: int
    head: LedgerHead
    """Newest entry of its ledger that is here."""
    still_to_come: int
    """Entries that the cell had beyond this one at the last delivery."""
    received: datetime | None
    """When that was, by the server's clock; None before the first."""
    age_s: float | None
    """Time since then, by the server's clock."""
    clock_ahead_s: float | None
    """How much the cell's clock was ahead of the server's then, travel time included."""
    software: str


@dataclass(frozen=True, slots=True)
class FoundRun:
    """A run and the cell that made it."""

    cell: str
    run: ListedRun


def cells(fleet: FleetDatabase, cell: str | None = None) -> list[FleetCell]:
    """Every cell by name, or one; raises the 83x faults."""
    return [_cell(fleet, *row) for row in _places(fleet, cell)]


def runs(
    fleet: FleetDatabase, wanted: RunFilter, limit: int, cell: str | None = None
) -> list[FoundRun]:
    """The newest of the wanted runs of all cells or of one, newest first.

    By the clocks of the cells, which order runs of one cell surely and of several nearly.
    """
    found = [
        FoundRun(name, run)
        for name, place, _ in _places(fleet, cell)
        for run in _runs_of(fleet, place, wanted, limit)
    ]
    return sorted(found, key=lambda one: one.run.head.started, reverse=True)[:limit]


def run(fleet: FleetDatabase, cell: str, number: int) -> tuple[RunRecord, list[AuditEntry]]:
    """One run with everything but its files, and the audit log of its cell.

    Raises ``RunUnknown`` and the 83x faults.
    """
    ((_, place, _),) = _places(fleet, cell)
    with fleet.view(place) as session:
        return reading.read_run(session, number), reading.audit_log(session)


def problems(fleet: FleetDatabase, cell: str, printed: LedgerHead | None = None) -> list[str]:
    """Where the records of a cell are not as the cell has sealed them; files stay at the cell."""
    ((_, place, _),) = _places(fleet, cell)
    with fleet.view(place) as session:
        behind = _still_to_come(session, ledger.head(session))
        return list(ledger.problems(session, printed, is_copy=True, more_to_come=behind > 0))


def _places(fleet: FleetDatabase, cell: str | None = None) -> Sequence[tuple[str, str, int]]:
    """Name, PostgreSQL schema and version of each cell; raises ``FleetRefused`` for a wrong one."""
    with fleet.view() as session:
        query = select(CellRow.name, CellRow.place, CellRow.record_schema).order_by(CellRow.name)
        found = [(row.name, row.place, row.record_schema) for row in session.execute(query)]
    wanted = [row for row in found if cell in (None, row[0])]
    if cell is not None and not wanted:
        known = ", ".join(row[0] for row in found) or "none"
        raise FleetRefused(f"there is no cell {cell!r}; there are: {known}")
    return wanted


def _cell(fleet: FleetDatabase, name: str, place: str, record_schema: int) -> FleetCell:
    with fleet.view(place) as session:
        head = ledger.head(session)
        columns = (*DeliveryRow.__table__.columns, func.now().label("now"))
        row = session.execute(select(*columns)).one_or_none()
    if row is None:
        return FleetCell(name, record_schema, head, 0, None, None, None, "")
    return FleetCell(
        name,
        record_schema,
        head,
        max(0, row.length - head.length),
        row.received,
        (row.now - row.received).total_seconds(),
        (row.sent - row.received).total_seconds(),
        row.software,
    )


def _still_to_come(session: Session, head: LedgerHead) -> int:
    length = session.scalar(select(DeliveryRow.length)) or 0
    return int(length) - head.length


def _runs_of(
    fleet: FleetDatabase, place: str, wanted: RunFilter, limit: int
) -> Iterator[ListedRun]:
    condition, values = wanted.sql("json_each_text")
    # Without a type: as a text, which most values are, PostgreSQL compares them with no time.
    untyped = [bindparam(name, value, NullType()) for name, value in values.items()]
    query = select(RunRow).where(text(condition).bindparams(*untyped))
    query = query.order_by(RunRow.number.desc()).limit(limit)
    with fleet.view(place) as session:
        for row in session.scalars(query).all():
            head = to_entry(row, RunHead)
            yield ListedRun(head, _is_spoilt(session, head))


def _is_spoilt(session: Session, head: RunHead) -> bool:
    """Whether a plug gauge has turned the good part of this run into a bad one."""
    if head.result != RunResult.GOOD:
        return False
    gauges = select(GaugeRow.id).where(GaugeRow.run == head.number).limit(1)
    if session.scalar(gauges) is None:
        return False
    return part_verdict(reading.read_run(session, head.number)) != head.result
