"""Tables of the run store. Times are UTC; lists and documents are JSON.

A row that the store gives out has the columns of an entry of ``cellctl.records.entries``, with the
same names, and ``run`` beside them. ``rows.py`` makes one of the other by those names.
"""

from collections.abc import Mapping
from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import BigInteger, Enum, ForeignKey, Index, Integer, String, text
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

from cellctl.records.database.column_types import PassComponents, PlainJson, Utc
from cellctl.records.entries import Matrix, PassComponent, PoseOrigin, Six, Verdict


def _by_value(kind: type[StrEnum]) -> Enum:
    """An enumeration kept as the text of its value, which is what other tools should read."""
    return Enum(kind, native_enum=False, values_callable=list, length=16)


class Base(DeclarativeBase):
    """Root of the tables."""

    type_annotation_map = {  # noqa: RUF012  # SQLAlchemy's own name
        datetime: Utc,
        # A file may be larger than the 2 GB that an INTEGER of PostgreSQL holds. SQLite, whose
        # integers have 64 bits anyway, numbers rows by itself in a column called INTEGER alone.
        int: BigInteger().with_variant(Integer, "sqlite"),
        Six: PlainJson,
        Matrix: PlainJson,
        Mapping[str, Any]: PlainJson,
        tuple[PassComponent, ...]: PassComponents,
        Verdict: _by_value(Verdict),
        PoseOrigin: _by_value(PoseOrigin),
    }


class CalibrationRow(Base):
    """A calibration as it was when it was stored."""

    __tablename__ = "calibrations"
    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    kind: Mapped[str]
    serial_number: Mapped[str]
    software: Mapped[str]
    made: Mapped[datetime]
    valid_until: Mapped[datetime]
    record: Mapped[Mapping[str, Any]]
    invalidated: Mapped[datetime | None]
    invalidated_reason: Mapped[str | None]


class RunRow(Base):
    """One run. Written before anything moves, closed once."""

    __tablename__ = "runs"
    number: Mapped[int] = mapped_column(primary_key=True)
    process: Mapped[str]
    serial: Mapped[str]
    recipe_id: Mapped[int]
    recipe_name: Mapped[str]
    recipe_hash: Mapped[str]
    mode: Mapped[str]
    operator: Mapped[str]
    software: Mapped[str]
    config_hash: Mapped[str]
    simulated: Mapped[bool]
    calibration_ids: Mapped[Mapping[str, Any]]
    started: Mapped[datetime]
    ended: Mapped[datetime | None]
    result: Mapped[str | None]
    fault_number: Mapped[int | None]
    fault: Mapped[str | None]
    record_schema: Mapped[int]
    """Schema of the tables that hold this run's details, and of the content that is sealed."""


class PhaseRow(Base):
    """A phase of a run; a phase that begins again gets a row of its own."""

    __tablename__ = "phases"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    number: Mapped[int]
    label: Mapped[str]
    began: Mapped[datetime]
    ended: Mapped[datetime | None]


class DetailOfRun:
    """Columns of every row that is a detail of a run and belongs to a phase."""

    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    phase: Mapped[int | None] = mapped_column(ForeignKey("phases.id"))


class FigureRow(DetailOfRun, Base):
    """A named figure with its unit, its limits and its verdict."""

    __tablename__ = "figures"
    key: Mapped[str]
    label: Mapped[str]
    value: Mapped[float | None]
    unit: Mapped[str]
    lower: Mapped[float | None]
    upper: Mapped[float | None]
    verdict: Mapped[Verdict | None]


class PoseRow(DetailOfRun, Base):
    """A pose ``parent_T_child``: measured, commanded, or reported by a robot."""

    __tablename__ = "poses"
    key: Mapped[str]
    origin: Mapped[PoseOrigin]
    parent: Mapped[str]
    child: Mapped[str]
    pose_mm_deg: Mapped[Six]
    sigma_mm_deg: Mapped[Six | None]
    covariance_mm_deg: Mapped[Matrix | None]
    residual_um: Mapped[float | None]
    frames: Mapped[int | None]
    detail: Mapped[Mapping[str, Any]]


class PassRow(DetailOfRun, Base):
    """One pass of a loop that measures and corrects."""

    __tablename__ = "passes"
    loop: Mapped[str]
    number: Mapped[int]
    components: Mapped[tuple[PassComponent, ...]]
    converged: Mapped[bool]
    residual_um: Mapped[float | None]
    frames: Mapped[int | None]


class DocumentRow(DetailOfRun, Base):
    """What a process knows of a run besides figures and poses, as plain data."""

    __tablename__ = "documents"
    key: Mapped[str] = mapped_column(index=True)
    content: Mapped[Mapping[str, Any]]


class ArtefactRow(Base):
    """A file that belongs to a run; its bytes lie beside the database under their SHA-256."""

    __tablename__ = "artefacts"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    name: Mapped[str]
    sha256: Mapped[str] = mapped_column(String(64))
    size: Mapped[int]
    media_type: Mapped[str]


class AlarmRow(Base):
    """A fault or warning; survives restarts until somebody acknowledges it."""

    __tablename__ = "alarms"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int | None] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    number: Mapped[int]
    text: Mapped[str]
    acknowledged: Mapped[datetime | None]
    acknowledged_by: Mapped[str | None]


class GaugeRow(Base):
    """Plug-gauge result of a pin hole; may come after the run was closed, hence its own seal."""

    __tablename__ = "gauges"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    hole: Mapped[str]
    diameter_mm: Mapped[float]
    source: Mapped[str]
    gauge_id: Mapped[str | None]
    """Id of the plug gauge itself; None in rows of schema 1 and 2."""


COMMAND_KEY = "json_extract(detail, '$.key')"
"""Key of the command of the page that an audit line is about. An index serves whoever asks with
these very words."""


class AuditRow(Base):
    """Who did what. Rows are only ever appended."""

    __tablename__ = "audit"
    # Of SQLite alone: nobody asks a fleet's database what became of a command of a moment ago.
    __table_args__ = (
        Index(
            "ix_audit_command_key", text(COMMAND_KEY), sqlite_where=text(f"{COMMAND_KEY} NOT NULL")
        ).ddl_if(dialect="sqlite"),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    time: Mapped[datetime]
    actor: Mapped[str]
    action: Mapped[str]
    detail: Mapped[Mapping[str, Any]]


class LedgerRow(Base):
    """The hash chain over what may no longer change."""

    __tablename__ = "ledger"
    __table_args__ = (Index("ix_ledger_kind_subject", "kind", "subject"),)
    number: Mapped[int] = mapped_column(primary_key=True)
    time: Mapped[datetime]
    kind: Mapped[str]
    """One of the kinds of ``sealing/sealed.py``."""
    subject: Mapped[int]
    """Number of the run or id of the row; 0 for a subject that has a name."""
    name: Mapped[str | None]
    """Name of a subject without a number: the id of a calibration, the name of a value."""
    content: Mapped[str] = mapped_column(String(64))
    previous: Mapped[str] = mapped_column(String(64))
    hash: Mapped[str] = mapped_column(String(64), unique=True)


class LedgerHeadRow(Base):
    """Length and newest hash of the chain: a tail that was cut off shows."""

    __tablename__ = "ledger_head"
    id: Mapped[int] = mapped_column(primary_key=True)
    """Always 1."""
    length: Mapped[int]
    """Number of the newest entry."""
    hash: Mapped[str] = mapped_column(String(64))


class ValueRow(Base):
    """Small facts that must survive a restart."""

    __tablename__ = "persistent_values"
    name: Mapped[str] = mapped_column(primary_key=True)
    value: Mapped[int]
