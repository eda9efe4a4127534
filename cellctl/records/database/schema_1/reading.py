"""A run of schema 1 as figures, poses, passes and documents."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from sqlalchemy import select
from sqlalchemy.orm import Session

from cellctl.records.database.schema_1.tables import (
    IterationOfSchema1,
    MeasurementOfSchema1,
    RunOfSchema1,
    has_tables,
)
from cellctl.records.entries import (
    Document,
    Figure,
    LoopPass,
    PassComponent,
    PoseOrigin,
    RecordedPose,
)
from cellctl.records.figures import split_document

T = TypeVar("T")
Row = TypeVar("Row", MeasurementOfSchema1, IterationOfSchema1)

LOOP = "pose correction"
MATING = "mating"
COMPONENTS = (
    ("X", "mm"), ("Y", "mm"), ("Z", "mm"),
    ("rx", "°"), ("ry", "°"), ("rz", "°"),
)  # fmt: skip
_FRAMES = {"frame": ("c1", "frame"), "flange_T_deck": ("flange", "deck")}
_DECK = ("c1", "deck")
"""Frames of every other measurement: head 1 saw the deck."""


@dataclass(frozen=True, slots=True)
class Details:
    """What the tables of schema 1 hold of a run, in the terms of today."""

    figures: tuple[Figure, ...]
    poses: tuple[RecordedPose, ...]
    passes: tuple[LoopPass, ...]
    documents: tuple[Document, ...]


def read_details(session: Session, number: int) -> Details:
    """The details of a run; a run that does not exist has none."""
    row = session.get(RunOfSchema1, number) if has_tables(session) else None
    if row is None:
        return Details((), (), (), ())
    figures, rest = split_document(row.mating or {})
    # The mating was one column of the run without a time of its own: the end of the run is the
    # last moment at which it can have been written.
    time = row.ended or row.started
    return Details(
        figures=tuple(replace(entry, time=time) for entry in figures),
        poses=tuple(_pose(entry) for entry in _rows(session, MeasurementOfSchema1, number)),
        passes=tuple(_pass(entry) for entry in _rows(session, IterationOfSchema1, number)),
        documents=(Document(MATING, rest, time),) if rest else (),
    )


def _rows(session: Session, table: type[Row], number: int) -> Sequence[Row]:
    return session.scalars(select(table).where(table.run == number).order_by(table.id)).all()


def _pose(row: MeasurementOfSchema1) -> RecordedPose:
    parent, child = _FRAMES.get(row.kind, _DECK)
    return RecordedPose(
        key=row.kind,
        origin=PoseOrigin.MEASURED,
        parent=parent,
        child=child,
        pose_mm_deg=row.pose_mm_deg,
        sigma_mm_deg=row.sigma_mm_deg,
        residual_um=row.residual_um,
        frames=row.frames,
        detail=row.detail,
        time=row.time,
    )


def _pass(row: IterationOfSchema1) -> LoopPass:
    # Schema 1 wrote no components at all when nothing was corrected after a pass.
    corrections = row.correction_mm_deg or (None,) * len(COMPONENTS)
    columns = zip(
        COMPONENTS,
        row.error_mm_deg,
        row.sigma_mm_deg,
        row.threshold_mm_deg,
        corrections,
        strict=True,
    )
    return LoopPass(
        loop=LOOP,
        number=row.iteration,
        components=tuple(PassComponent(*head, *values) for head, *values in columns),
        converged=row.converged,
        residual_um=row.residual_um,
        frames=row.frames,
        time=row.time,
    )
