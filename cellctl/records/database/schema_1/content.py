"""What schema 1 has sealed of a run."""

from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.database.schema import RunRow
from cellctl.records.database.schema_1.tables import (
    PROCESS,
    ArtefactOfSchema1,
    IterationOfSchema1,
    MeasurementOfSchema1,
    RunOfSchema1,
    has_tables,
)
from cellctl.records.database.sealing.canonical import columns

_DETAILS = (MeasurementOfSchema1, IterationOfSchema1, ArtefactOfSchema1)


def sealed_content(session: Session, number: int) -> dict[str, Any] | None:
    """The run and its details; None when there can be no such run.

    ``process`` came with schema 2 and is in no old seal. It can have one value only, which is
    checked here in place of a hash.
    """
    if not has_tables(session):
        return None
    row = session.get(RunOfSchema1, number)
    process = session.scalar(select(RunRow.process).where(RunRow.number == number))
    if row is None or process != PROCESS:
        return None
    document = columns(row)
    for table in _DETAILS:
        rows = session.scalars(select(table).where(table.run == number).order_by(table.id))
        document[table.__tablename__] = [columns(detail) for detail in rows]
    return document
