"""Reads whole runs from the tables."""

from collections.abc import Iterator
from datetime import datetime
from typing import Any, TypeVar

from sqlalchemy import ColumnElement, func, literal_column, or_, select
from sqlalchemy.orm import Session

from cellctl.errors.records.store import ArtefactDamaged
from cellctl.records.database import schema_1
from cellctl.records.database.rows import existing_run, to_entry
from cellctl.records.database.schema import (
    COMMAND_KEY,
    AlarmRow,
    ArtefactRow,
    AuditRow,
    CalibrationRow,
    DocumentRow,
    FigureRow,
    GaugeRow,
    LedgerRow,
    PassRow,
    PhaseRow,
    PoseRow,
    RunRow,
)
from cellctl.records.database.sealing.sealed import RUN
from cellctl.records.entries import (
    PRODUCTION,
    Alarm,
    Artefact,
    AuditEntry,
    Calibration,
    Document,
    Figure,
    Gauge,
    LoopPass,
    Phase,
    RecordedPose,
    RunHead,
    RunRecord,
    RunResult,
)
from cellctl.records.files.artefacts import ArtefactFolder
from cellctl.records.parts import MATE_SERIAL, PARTS
from cellctl.records.run_filter import AlarmFilter
from cellctl.records.seals import Seal
from cellctl.records.trend import Sample

T = TypeVar("T")
_FINISHED = (RunResult.GOOD, RunResult.BAD)


def calibrations(session: Session, kind: str = "", limit: int | None = None) -> list[Calibration]:
    """Every calibration that was ever stored, or the newest ones, of one kind; newest first."""
    query = select(CalibrationRow).order_by(CalibrationRow.made.desc()).limit(limit)
    if kind:
        query = query.where(CalibrationRow.kind == kind)
    return [to_entry(row, Calibration) for row in session.scalars(query)]


def audit_log(session: Session) -> list[AuditEntry]:
    """Every entry of the audit log, oldest first."""
    found = session.scalars(select(AuditRow).order_by(AuditRow.id))
    return [to_entry(row, AuditEntry) for row in found]


def newest_audit(session: Session, limit: int) -> list[AuditEntry]:
    """The newest entries of the audit log, newest first."""
    found = session.scalars(select(AuditRow).order_by(AuditRow.id.desc()).limit(limit))
    return [to_entry(row, AuditEntry) for row in found]


def audit_of_command(session: Session, key: str) -> list[AuditEntry]:
    """Entries of the audit log about the command of the page with this key, oldest first."""
    same = literal_column(COMMAND_KEY) == key
    found = session.scalars(select(AuditRow).where(same).order_by(AuditRow.id))
    return [to_entry(row, AuditEntry) for row in found]


def alarms(session: Session, wanted: AlarmFilter, limit: int) -> list[Alarm]:
    """The newest of the wanted alarms, newest first."""
    query = select(AlarmRow).where(*_conditions(wanted)).order_by(AlarmRow.id.desc()).limit(limit)
    return [to_entry(row, Alarm) for row in session.scalars(query)]


def alarm_count(session: Session, wanted: AlarmFilter) -> int:
    """How many alarms are wanted."""
    return session.scalars(select(func.count(AlarmRow.id)).where(*_conditions(wanted))).one()


def _conditions(wanted: AlarmFilter) -> Iterator[ColumnElement[bool]]:
    never = AlarmRow.acknowledged.is_(None)
    if wanted.active is not None:
        yield never if wanted.active else ~never
    if wanted.before is not None:
        yield AlarmRow.id < wanted.before
    if wanted.number is not None:
        yield AlarmRow.number == wanted.number
    if wanted.run is not None:
        yield AlarmRow.run == wanted.run
    if wanted.since is not None:
        yield AlarmRow.time >= wanted.since
    if wanted.until is not None:
        yield AlarmRow.time < wanted.until


def alarm(session: Session, number: int) -> Alarm | None:
    """The alarm with this id."""
    row = session.get(AlarmRow, number)
    return None if row is None else to_entry(row, Alarm)


def calibration(session: Session, identity: str) -> Calibration | None:
    """The calibration with this id."""
    row = session.get(CalibrationRow, identity)
    return None if row is None else to_entry(row, Calibration)


def run_heads(
    session: Session, limit: int, serial: str | None, mate_serial: str | None
) -> list[RunHead]:
    """The newest runs, newest first; of one serial number, or joined to one, if given."""
    query = select(RunRow).order_by(RunRow.number.desc()).limit(limit)
    if serial is not None:
        query = query.where(RunRow.serial == serial)
    if mate_serial is not None:
        named = func.json_extract(DocumentRow.content, f"$.{MATE_SERIAL}") == mate_serial
        # By the key first: content is read of the few rows that are left.
        joined = select(DocumentRow.run).where(DocumentRow.key == PARTS, named)
        query = query.where(RunRow.number.in_(joined))
    return [to_entry(row, RunHead) for row in session.scalars(query)]


def last_phase(session: Session, number: int) -> Phase | None:
    """The phase that a run began last."""
    query = select(PhaseRow).where(PhaseRow.run == number).order_by(PhaseRow.id.desc())
    row = session.scalars(query.limit(1)).first()
    return None if row is None else to_entry(row, Phase)


def cell_alarms(session: Session, begin: datetime, end: datetime | None) -> list[Alarm]:
    """Alarms of no run that came or stood in a stretch of time, oldest first."""
    standing = or_(AlarmRow.acknowledged.is_(None), AlarmRow.acknowledged >= begin)
    query = select(AlarmRow).where(AlarmRow.run.is_(None), standing).order_by(AlarmRow.id)
    if end is not None:
        query = query.where(AlarmRow.time <= end)
    return [to_entry(row, Alarm) for row in session.scalars(query)]


def good_parts(session: Session) -> int:
    """Runs of Production that ended with a good part."""
    # Counted by the database: a store of years has a hundred thousand runs.
    good = RunRow.mode == PRODUCTION, RunRow.result == RunResult.GOOD
    return session.scalar(select(func.count()).select_from(RunRow).where(*good)) or 0


def figure_keys(session: Session) -> list[str]:
    """Keys of all figures that any run has."""
    return list(session.scalars(select(FigureRow.key).distinct().order_by(FigureRow.key)))


def figure_history(
    session: Session, key: str, recipe_id: int | None, limit: int
) -> tuple[list[Sample], str]:
    """The newest known value of each finished run of Production, the oldest first, and the unit.

    Finished are runs that came to their end, good or bad. The peak of a contact that was cut off
    says nothing of a process.

    Runs of schema 1 have none: their figures stand in other tables.
    """
    # A further attempt of a run replaces what an earlier one has found: the last row counts.
    last = (
        select(func.max(FigureRow.id))
        .where(FigureRow.key == key, FigureRow.value.is_not(None))
        .group_by(FigureRow.run)
    )
    query = (
        select(RunRow, FigureRow)
        .join(FigureRow, FigureRow.run == RunRow.number)
        .where(FigureRow.id.in_(last), RunRow.result.in_(_FINISHED))
        .where(RunRow.mode == PRODUCTION)
        .order_by(RunRow.number.desc())
        .limit(limit)
    )
    if recipe_id is not None:
        query = query.where(RunRow.recipe_id == recipe_id)
    found = [(run, figure) for run, figure in session.execute(query).all()][::-1]
    samples = [
        Sample(run.number, run.started, figure.value, figure.lower, figure.upper)
        for run, figure in found
        if figure.value is not None
    ]
    return samples, found[-1][1].unit if found else ""


def read_run(session: Session, number: int) -> RunRecord:
    """One run with everything that belongs to it; raises ``RunUnknown``."""
    row = existing_run(session, number)
    # Their tables are left as they are, because their seals were made over those
    # (docs/decisions/0013).
    if row.record_schema == 1:
        details = schema_1.read_details(session, number)
    else:
        details = _details(session, number)
    sealed = session.scalars(
        select(LedgerRow).where(LedgerRow.kind == RUN, LedgerRow.subject == number)
    ).first()
    gauges = _entries(session, GaugeRow, Gauge, number)
    return RunRecord(
        head=to_entry(row, RunHead),
        phases=_entries(session, PhaseRow, Phase, number),
        figures=details.figures,
        poses=details.poses,
        passes=details.passes,
        documents=details.documents,
        artefacts=_entries(session, ArtefactRow, Artefact, number),
        alarms=_entries(session, AlarmRow, Alarm, number),
        # By hole, so that the later entry of a hole takes the place of the earlier one; the history
        # keeps both.
        gauges=tuple({gauge.hole: gauge for gauge in gauges}.values()),
        gauge_history=gauges,
        seal=None if sealed is None else to_entry(sealed, Seal),
    )


def damaged_files(session: Session, files: ArtefactFolder) -> Iterator[str]:
    """Every file of a run that is missing or not as it was stored."""
    for row in session.scalars(select(ArtefactRow).order_by(ArtefactRow.id)):
        try:
            files.get(row.sha256)
        except ArtefactDamaged as error:
            yield f"run {row.run}, {row.name}: {error}"


def newest_time(session: Session) -> datetime | None:
    """When the newest record of a store was written."""
    columns = (RunRow.started, RunRow.ended, AuditRow.time, AlarmRow.time, LedgerRow.time)
    times = [session.scalar(select(func.max(column))) for column in columns]
    return max((time for time in times if time is not None), default=None)


def _details(session: Session, number: int) -> schema_1.Details:
    return schema_1.Details(
        figures=_entries(session, FigureRow, Figure, number),
        poses=_entries(session, PoseRow, RecordedPose, number),
        passes=_entries(session, PassRow, LoopPass, number),
        documents=_entries(session, DocumentRow, Document, number),
    )


def _entries(session: Session, table: Any, entry: type[T], number: int) -> tuple[T, ...]:
    rows = session.scalars(select(table).where(table.run == number).order_by(table.id))
    return tuple(to_entry(row, entry) for row in rows)
