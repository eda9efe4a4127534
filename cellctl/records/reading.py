"""Rows to frozen values."""

from datetime import datetime
from typing import Any, TypeVar

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from cellctl.errors.records import RunUnknown
from cellctl.records.entries import (
    Alarm,
    Artefact,
    Gauge,
    Iteration,
    Measurement,
    RunHead,
    RunRecord,
    Seal,
)
from cellctl.records.ledger import RUN
from cellctl.records.schema import (
    AlarmRow,
    ArtefactRow,
    AuditRow,
    GaugeRow,
    IterationRow,
    LedgerRow,
    MeasurementRow,
    RunRow,
)

T = TypeVar("T")


def read_run(session: Session, number: int) -> RunRecord:
    """One run with everything that belongs to it; raises ``RunUnknown``."""
    row = session.get(RunRow, number)
    if row is None:
        raise RunUnknown(str(number))
    sealed = session.scalars(
        select(LedgerRow).where(LedgerRow.kind == RUN, LedgerRow.subject == number)
    ).first()
    gauges = {gauge.hole: gauge for gauge in _details(session, GaugeRow, Gauge, number)}
    return RunRecord(
        head=convert(row, RunHead),
        measurements=_details(session, MeasurementRow, Measurement, number),
        iterations=_details(session, IterationRow, Iteration, number),
        mating=row.mating,
        artefacts=_details(session, ArtefactRow, Artefact, number),
        alarms=_details(session, AlarmRow, Alarm, number),
        gauges=tuple(gauges.values()),
        seal=None if sealed is None else convert(sealed, Seal),
    )


def newest_time(session: Session) -> datetime | None:
    """When the newest record of a store was written."""
    columns = (RunRow.started, RunRow.ended, AuditRow.time, AlarmRow.time, LedgerRow.time)
    times = [session.scalar(select(func.max(column))) for column in columns]
    return max((time for time in times if time is not None), default=None)


def convert(row: Any, into: type[T]) -> T:
    """A row as a dataclass that names a part of its columns."""
    fields = into.__dataclass_fields__  # type: ignore[attr-defined]
    values = {name: getattr(row, name) for name in fields}
    return into(**{name: tuple(v) if isinstance(v, list) else v for name, v in values.items()})


def _details(session: Session, table: Any, into: type[T], number: int) -> tuple[T, ...]:
    rows = session.scalars(select(table).where(table.run == number).order_by(table.id))
    return tuple(convert(row, into) for row in rows)
