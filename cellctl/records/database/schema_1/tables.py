"""Tables of schema 1 as they lie in a migrated store, beside those of today.

They stay as they were written: the ledger has sealed exactly these columns, so a copy in other
tables could neither be verified nor replace them. Nothing but runs of schema 1 is ever in them.
"""

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, inspect
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column

from cellctl.records.database.column_types import PlainJson, Utc
from cellctl.records.entries import Six

PROCESS = "deck-to-frame"
"""The one process whose runs a store of schema 1 holds."""


def has_tables(session: Session) -> bool:
    """Whether a store was migrated from schema 1; a new one has none of these tables."""
    return inspect(session.connection()).has_table(MeasurementOfSchema1.__tablename__)


class BaseOfSchema1(DeclarativeBase):
    """Root of the tables of schema 1."""

    type_annotation_map = {  # noqa: RUF012  # SQLAlchemy's own name
        datetime: Utc,
        Six: PlainJson,
        Mapping[str, Any]: PlainJson,
    }


class RunOfSchema1(BaseOfSchema1):
    """The columns of a run that schema 1 has sealed."""

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
    calibration_ids: Mapped[Mapping[str, Any]]
    started: Mapped[datetime]
    ended: Mapped[datetime | None]
    result: Mapped[str | None]
    fault_number: Mapped[int | None]
    fault: Mapped[str | None]
    mating: Mapped[Mapping[str, Any] | None]


class MeasurementOfSchema1(BaseOfSchema1):
    """A measured pose."""

    __tablename__ = "measurements"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"))
    time: Mapped[datetime]
    kind: Mapped[str]
    pose_mm_deg: Mapped[Six]
    sigma_mm_deg: Mapped[Six]
    residual_um: Mapped[float | None]
    frames: Mapped[int]
    detail: Mapped[Mapping[str, Any]]


class IterationOfSchema1(BaseOfSchema1):
    """One pass of the loop that corrects the pose of the deck."""

    __tablename__ = "iterations"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"))
    time: Mapped[datetime]
    iteration: Mapped[int]
    error_mm_deg: Mapped[Six]
    sigma_mm_deg: Mapped[Six]
    threshold_mm_deg: Mapped[Six]
    frames: Mapped[int]
    residual_um: Mapped[float | None]
    converged: Mapped[bool]
    correction_mm_deg: Mapped[Six]


class ArtefactOfSchema1(BaseOfSchema1):
    """A file of the run."""

    __tablename__ = "artefacts"
    id: Mapped[int] = mapped_column(primary_key=True)
    run: Mapped[int] = mapped_column(ForeignKey("runs.number"))
    time: Mapped[datetime]
    name: Mapped[str]
    sha256: Mapped[str]
    size: Mapped[int]
    media_type: Mapped[str]
