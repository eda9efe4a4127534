"""Tables of the run store. Times are UTC; lists and documents are JSON."""

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import JSON, DateTime, Dialect, ForeignKey, String
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator

SCHEMA_VERSION = 1


class Utc(TypeDecorator[datetime]):
    """Aware UTC on this side, naive in SQLite, which knows no zones."""

    impl = DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, _dialect: Dialect) -> datetime | None:
        """To the database."""
        return None if value is None else value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, _dialect: Dialect) -> datetime | None:
        """From the database."""
        return None if value is None else value.replace(tzinfo=UTC)


class Base(DeclarativeBase):
    """Root of the tables."""

    type_annotation_map = {  # noqa: RUF012  # SQLAlchemy's own name
        datetime: Utc,
        list[float | None]: JSON,
        dict[str, Any]: JSON,
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
    record: Mapped[dict[str, Any]]
    invalidated: Mapped[datetime | None]
    invalidated_reason: Mapped[str | None]


class RunRow(Base):
    """One run. Written before anything moves, closed once."""

    __tablename__ = "runs"
    number: Mapped[int] = mapped_column(primary_key=True)
    serial: Mapped[str]
    recipe_id: Mapped[int]
    recipe_name: Mapped[str]
    recipe_hash: Mapped[str]
    mode: Mapped[str]
    operator: Mapped[str]
    software: Mapped[str]
    config_hash: Mapped[str]
    simulated: Mapped[bool]
    calibration_ids: Mapped[dict[str, Any]]
    started: Mapped[datetime]
    ended: Mapped[datetime | None]
    result: Mapped[str | None]
    fault_number: Mapped[int | None]
    fault: Mapped[str | None]
    mating: Mapped[dict[str, Any] | None]


class MeasurementRow(Base):
    """A measured pose."""

    __tablename__ = "measurements"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    kind: Mapped[str]
    pose_mm_deg: Mapped[list[float | None]]
    sigma_mm_deg: Mapped[list[float | None]]
    residual_um: Mapped[float | None]
    frames: Mapped[int]
    detail: Mapped[dict[str, Any]]


class IterationRow(Base):
    """One pass of the measure-compensate loop."""

    __tablename__ = "iterations"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    iteration: Mapped[int]
    error_mm_deg: Mapped[list[float | None]]
    sigma_mm_deg: Mapped[list[float | None]]
    threshold_mm_deg: Mapped[list[float | None]]
    frames: Mapped[int]
    residual_um: Mapped[float | None]
    converged: Mapped[bool]
    correction_mm_deg: Mapped[list[float | None]]


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
    """Plug-gauge result of a pin hole; may come after the run was closed, hence its own entry."""

    __tablename__ = "gauges"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"), index=True)
    time: Mapped[datetime]
    hole: Mapped[str]
    diameter_mm: Mapped[float]
    source: Mapped[str]


class AuditRow(Base):
    """Who did what. Only ever appended."""

    __tablename__ = "audit"
    id: Mapped[int] = mapped_column(primary_key=True)
    time: Mapped[datetime]
    actor: Mapped[str]
    action: Mapped[str]
    detail: Mapped[dict[str, Any]]


class LedgerRow(Base):
    """The hash chain over what may no longer change."""

    __tablename__ = "ledger"
    number: Mapped[int] = mapped_column(primary_key=True)
    time: Mapped[datetime]
    kind: Mapped[str]
    """``run`` or ``gauge``."""
    subject: Mapped[int]
    """Number of the run or id of the gauge row."""
    content: Mapped[str] = mapped_column(String(64))
    previous: Mapped[str] = mapped_column(String(64))
    hash: Mapped[str] = mapped_column(String(64), unique=True)


class ValueRow(Base):
    """Small facts that must survive a restart."""

    __tablename__ = "persistent_values"
    name: Mapped[str] = mapped_column(primary_key=True)
    value: Mapped[int]
