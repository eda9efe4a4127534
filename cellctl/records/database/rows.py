"""Makes rows of entries and entries of rows, by the names of their fields."""

from collections.abc import Sequence
from dataclasses import fields
from datetime import datetime
from typing import Any, TypeVar

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.clock import utc_now
from cellctl.errors.records.store import RunClosed, RunUnknown
from cellctl.records.database.schema import (
    AlarmRow,
    ArtefactRow,
    Base,
    CalibrationRow,
    DocumentRow,
    FigureRow,
    PassRow,
    PhaseRow,
    PoseRow,
    RunRow,
)
from cellctl.records.database.sealing import ledger
from cellctl.records.database.sealing.sealed import RUN
from cellctl.records.entries import (
    Document,
    Figure,
    LoopPass,
    RecordedPose,
    RunDetail,
    RunResult,
)

T = TypeVar("T")

ROW_OF: dict[type[RunDetail], type[FigureRow | PoseRow | PassRow | DocumentRow]] = {
    Figure: FigureRow,
    RecordedPose: PoseRow,
    LoopPass: PassRow,
    Document: DocumentRow,
}


def to_row(entry: RunDetail, run: int, phase: int | None) -> Base:
    """The row of a detail of a run that is in a phase."""
    # By name, so that a column which is added to an entry and its table needs no line here.
    values = {item.name: getattr(entry, item.name) for item in fields(entry)}
    return ROW_OF[type(entry)](**values | {"run": run, "phase": phase})


def to_entry(row: Any, entry: type[T]) -> T:
    """A row as the dataclass that names a part of its columns."""
    values = {item.name: getattr(row, item.name) for item in fields(entry)}  # type: ignore[arg-type]
    return entry(**values)


def artefact(run: int, name: str, media_type: str, sha256: str, size: int) -> ArtefactRow:
    """The row of a file of a run, whose bytes are on the disk by now."""
    return ArtefactRow(
        run=run, time=utc_now(), name=name, sha256=sha256, size=size, media_type=media_type
    )


def calibration(stored: StoredCalibration) -> CalibrationRow:
    """The row of a calibration."""
    return CalibrationRow(
        id=stored.id,
        kind=stored.kind,
        serial_number=stored.serial_number,
        software=stored.software,
        made=stored.made,
        valid_until=stored.valid_until,
        record=stored.record,
    )


_GREATEST = 2**63 - 1
"""Greatest integer that SQLite takes."""


def existing_run(session: Session, number: int) -> RunRow:
    """The row; raises ``RunUnknown``."""
    row = session.get(RunRow, number) if abs(number) <= _GREATEST else None
    if row is None:
        raise RunUnknown(str(number))
    return row


def open_run(session: Session, number: int) -> RunRow:
    """The row of a run that may still change; raises ``RunUnknown`` or ``RunClosed``."""
    row = existing_run(session, number)
    if row.ended is not None:
        raise RunClosed(f"run {number}, {row.result}")
    return row


def open_runs(session: Session) -> Sequence[RunRow]:
    """The rows of all runs that nobody has closed."""
    return session.scalars(select(RunRow).where(RunRow.ended.is_(None))).all()


def open_phase(session: Session, run: int) -> PhaseRow | None:
    """The phase that a run is in."""
    query = select(PhaseRow).where(PhaseRow.run == run, PhaseRow.ended.is_(None))
    return session.scalars(query).one_or_none()


def close(
    session: Session,
    row: RunRow,
    result: RunResult,
    fault_number: int | None,
    fault: str | None,
    *,
    ended: datetime | None = None,
) -> None:
    """Close a run and seal it now; it has ended now, too, unless ``ended`` says when."""
    now = utc_now()
    row.ended, row.result = ended or now, result.value
    row.fault_number, row.fault = fault_number, fault
    phase = open_phase(session, row.number)
    # Nobody knows when an interrupted phase ended: its end stays unknown rather than invented.
    if phase is not None and result is not RunResult.INTERRUPTED:
        phase.ended = row.ended
    ledger.seal(session, RUN, row, now)


def active_alarm_rows() -> Select[AlarmRow]:
    """Alarms nobody has acknowledged, the oldest first."""
    return select(AlarmRow).where(AlarmRow.acknowledged.is_(None)).order_by(AlarmRow.id)
