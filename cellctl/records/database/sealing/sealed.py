"""What the ledger seals: for each kind the row, and the columns that may no longer change."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.database import schema_1
from cellctl.records.database.schema import (
    AlarmRow,
    AuditRow,
    Base,
    CalibrationRow,
    GaugeRow,
    RunRow,
    ValueRow,
)
from cellctl.records.database.sealing.canonical import columns
from cellctl.records.database.sealing.written_details import DETAILS, WrittenDetails

RUN, GAUGE, PROGRESS = "run", "gauge", "progress"
OPENING, AUDIT, VALUE = "opening", "audit", "value"
ALARM, ACKNOWLEDGEMENT = "alarm", "acknowledgement"
CALIBRATION, INVALIDATION = "calibration", "invalidation"

FILLED: Mapping[str, frozenset[str]] = {
    RUN: frozenset({"ended", "result", "fault_number", "fault"}),
    ACKNOWLEDGEMENT: frozenset({"acknowledged", "acknowledged_by"}),
    INVALIDATION: frozenset({"invalidated", "invalidated_reason"}),
}
"""Columns that are empty until an entry of this kind fills and seals them."""

Content = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class SealedKind:
    """One kind of ledger entry."""

    table: type[Base]
    key: str
    """Column that names a row: its number, or a text."""
    content: Callable[[Session, Any], Content | None]
    """What is sealed of a row; None where there is nothing to be sealed."""
    superseded: bool = False
    """A later entry of the same subject replaces an earlier one."""

    def row(self, session: Session, key: int | str) -> Any:
        """The row, or None."""
        return session.get(self.table, key)


def _run(session: Session, row: RunRow) -> Content | None:
    """A closed run with its details, in the tables of the schema that wrote it.

    Raises ``LookupError`` for a run that cannot be of the schema that it claims.
    """
    # An open run still changes, and has none of what closes it. What it began with is sealed by the
    # entry of its opening.
    if all(getattr(row, name) is None for name in FILLED[RUN]):
        return None
    if row.record_schema == 1:
        content = schema_1.sealed_content(session, row.number)
        if content is None:
            raise LookupError(f"run {row.number} is none of schema 1")
        return content
    details = {
        table.__tablename__: [
            columns(detail)
            for detail in session.scalars(
                select(table).where(table.run == row.number).order_by(table.id)
            )
        ]
        for table in DETAILS
    }
    return columns(row) | details


def _opening(_session: Session, row: RunRow) -> Content | None:
    """Earlier versions sealed no openings."""
    return None if row.record_schema < 3 else _without(row, FILLED[RUN])


def _progress(session: Session, row: RunRow) -> Content | None:
    """The details, also of an open run; earlier versions sealed them at its closing only."""
    return (
        None if row.record_schema < 4 else WrittenDetails.read(session, row.number).hashes or None
    )


def _gauge(_session: Session, row: GaugeRow) -> Content:
    """The gauge's own id came with schema 3: without one the content is that of before."""
    content = columns(row)
    return content if row.gauge_id is not None else _without(row, frozenset({"gauge_id"}))


def _acknowledgement(_session: Session, row: AlarmRow) -> Content | None:
    return _if_any(row, FILLED[ACKNOWLEDGEMENT])


def _invalidation(_session: Session, row: CalibrationRow) -> Content | None:
    return _if_any(row, FILLED[INVALIDATION])


def _without(row: Base, names: frozenset[str]) -> dict[str, Any]:
    return {name: value for name, value in columns(row).items() if name not in names}


def _if_any(row: AlarmRow | CalibrationRow, names: frozenset[str]) -> Content | None:
    """These columns of a row, or None while all of them are empty."""
    content = {name: value for name, value in columns(row).items() if name in names}
    filled = any(value is not None for value in content.values())
    return content | {"id": row.id} if filled else None


KINDS: Mapping[str, SealedKind] = {
    OPENING: SealedKind(RunRow, "number", _opening),
    PROGRESS: SealedKind(RunRow, "number", _progress, superseded=True),
    RUN: SealedKind(RunRow, "number", _run),
    GAUGE: SealedKind(GaugeRow, "id", _gauge),
    ALARM: SealedKind(AlarmRow, "id", lambda _, row: _without(row, FILLED[ACKNOWLEDGEMENT])),
    ACKNOWLEDGEMENT: SealedKind(AlarmRow, "id", _acknowledgement),
    CALIBRATION: SealedKind(
        CalibrationRow, "id", lambda _, row: _without(row, FILLED[INVALIDATION])
    ),
    INVALIDATION: SealedKind(CalibrationRow, "id", _invalidation),
    AUDIT: SealedKind(AuditRow, "id", lambda _, row: columns(row)),
    VALUE: SealedKind(ValueRow, "name", lambda _, row: columns(row), superseded=True),
}
"""The kinds by the name in the column ``kind``. Names and contents never change: stores are sealed
with them."""
SEALED_FROM_3_ON = (ALARM, ACKNOWLEDGEMENT, CALIBRATION, INVALIDATION, AUDIT, VALUE)
"""Kinds whose rows earlier versions have written without a seal."""
