"""The hash chain: what is closed can be proved unchanged.

Each entry hashes the content it seals together with the entry before it, so a change, a removal
or an insertion breaks every later hash. A chain that somebody recomputes as a whole cannot be
found out from the store alone; print the newest hash on the report, or keep it elsewhere.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.schema import (
    ArtefactRow,
    GaugeRow,
    IterationRow,
    LedgerRow,
    MeasurementRow,
    RunRow,
)

GENESIS = "0" * 64
RUN, GAUGE = "run", "gauge"
_DETAILS = (MeasurementRow, IterationRow, ArtefactRow)


def seal(session: Session, kind: str, subject: int, time: datetime) -> None:
    """Append an entry for a closed run or a gauge result."""
    last = session.scalars(select(LedgerRow).order_by(LedgerRow.number.desc()).limit(1)).first()
    previous = last.hash if last else GENESIS
    content = _content(session, kind, subject)
    row = LedgerRow(time=time, kind=kind, subject=subject, content=content, previous=previous)
    row.hash = _entry_hash(row)
    session.add(row)


def problems(session: Session) -> Iterator[str]:
    """Every place where the chain does not fit; nothing when all is as it was sealed."""
    previous = GENESIS
    sealed: set[int] = set()
    for row in session.scalars(select(LedgerRow).order_by(LedgerRow.number)):
        what = f"ledger entry {row.number} ({row.kind} {row.subject})"
        if row.previous != previous:
            yield f"{what} does not follow the entry before it"
        if row.hash != _entry_hash(row):
            yield f"{what} was changed"
        if row.content != _content(session, row.kind, row.subject):
            yield f"{row.kind} {row.subject} was changed after it was sealed"
        if row.kind == RUN:
            sealed.add(row.subject)
        previous = row.hash
    for number in session.scalars(select(RunRow.number).where(RunRow.ended.is_not(None))):
        if number not in sealed:
            yield f"run {number} is closed but not sealed"


def _content(session: Session, kind: str, subject: int) -> str:
    row = session.get(RunRow if kind == RUN else GaugeRow, subject)
    if row is None:
        return ""
    document: dict[str, Any] = _columns(row)
    if kind == RUN:
        for table in _DETAILS:
            rows = session.scalars(select(table).where(table.run == subject).order_by(table.id))
            document[table.__tablename__] = [_columns(detail) for detail in rows]
    return _digest(document)


def _entry_hash(row: LedgerRow) -> str:
    return _digest(
        {
            "time": row.time,
            "kind": row.kind,
            "subject": row.subject,
            "content": row.content,
            "previous": row.previous,
        }
    )


def _columns(row: Any) -> dict[str, Any]:
    return {column.key: getattr(row, column.key) for column in row.__table__.columns}


def _digest(document: Mapping[str, Any]) -> str:
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> str:
    if isinstance(value, datetime):
        return value.isoformat()
    raise TypeError(f"{type(value).__name__} has no canonical form")
