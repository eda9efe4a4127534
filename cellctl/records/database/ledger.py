"""The hash chain: what is closed can be proved unchanged.

Each entry hashes the content it seals together with the entry before it, so a change, a removal
or an insertion breaks every later hash. A chain that somebody recomputes as a whole cannot be
found out from the store alone; print the newest hash on the report, or keep it elsewhere.

The content of a run depends on the schema that wrote it (``runs.record_schema``): an old run is
sealed and verified over the tables of its own time, which a migration leaves as they are. That
column needs no seal of its own, since with another value the content is another one too.
"""

from collections.abc import Iterator
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.database import schema_1
from cellctl.records.database.canonical import columns, digest
from cellctl.records.database.schema import (
    ArtefactRow,
    DocumentRow,
    FigureRow,
    GaugeRow,
    LedgerRow,
    PassRow,
    PhaseRow,
    PoseRow,
    RunRow,
)

GENESIS = "0" * 64
RUN, GAUGE = "run", "gauge"
_DETAILS = (PhaseRow, FigureRow, PoseRow, PassRow, DocumentRow, ArtefactRow)


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
    if not isinstance(row, RunRow):
        return digest(columns(row))
    if row.record_schema == 1:
        document = schema_1.sealed_content(session, subject)
        return "" if document is None else digest(document)
    return digest(columns(row) | _details(session, subject))


def _details(session: Session, run: int) -> dict[str, Any]:
    return {
        table.__tablename__: [
            columns(detail)
            for detail in session.scalars(select(table).where(table.run == run).order_by(table.id))
        ]
        for table in _DETAILS
    }


def _entry_hash(row: LedgerRow) -> str:
    return digest(
        {
            "time": row.time,
            "kind": row.kind,
            "subject": row.subject,
            "content": row.content,
            "previous": row.previous,
        }
    )
