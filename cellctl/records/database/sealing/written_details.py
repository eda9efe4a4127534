"""A running hash over the details of a run, made while they are written.

Its value goes into the ledger with every write, and the next one is made of it and of what was
written then: whoever changes a detail of an open run, before its closing seals all of it, leaves a
value that does not follow from the rows.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from sqlalchemy import Row, select
from sqlalchemy.orm import Session

from cellctl.records.database.schema import (
    ArtefactRow,
    Base,
    DocumentRow,
    FigureRow,
    PassRow,
    PhaseRow,
    PoseRow,
)
from cellctl.records.database.sealing.canonical import digest

DETAILS = (PhaseRow, FigureRow, PoseRow, PassRow, DocumentRow, ArtefactRow)
"""Tables of the details of a run; a table stands after those that it refers to."""
_FILLED_LATER = frozenset({"ended"})
"""Columns of a phase that are empty when it is written; closing the run seals them."""


@dataclass(frozen=True, slots=True)
class WrittenDetails:
    """What has been written of one run so far."""

    hashes: Mapping[str, str] = field(default_factory=dict)
    """Hash of each table by its name, over its rows in their order."""

    @classmethod
    def read(cls, session: Session, run: int) -> Self:
        """The details of a run as its rows say them now."""
        written = cls()
        for table in DETAILS:
            columns = table.__table__.c
            query = select(table.__table__).where(columns.run == run).order_by(columns.id)
            written = written._with(table.__tablename__, session.execute(query))
        return written

    def and_then(self, session: Session, rows: Iterable[Base]) -> Self:
        """With rows that this session has just written, as the database has taken them."""
        session.flush()
        ids = defaultdict(list)
        for row in rows:
            ids[type(row)].append(row.id)  # type: ignore[attr-defined]  # every detail has one
        written = self
        for table in ids:
            columns = table.__table__.c
            # Read back, because a number may come back as another type than it was given.
            query = select(table.__table__).where(columns.id.in_(ids[table])).order_by(columns.id)
            written = written._with(table.__tablename__, session.execute(query))
        return written

    def _with(self, table: str, rows: Iterable[Row[Any]]) -> Self:
        value = self.hashes.get(table, "")
        for row in rows:
            columns = {name: one for name, one in row._mapping.items() if name not in _FILLED_LATER}
            value = digest({"before": value, "row": columns})
        return type(self)({**self.hashes, table: value} if value else self.hashes)
