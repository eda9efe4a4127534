"""Recall: the parts that a calibration has touched, and what stands behind a part."""

from typing import Annotated

from fastapi import APIRouter, Path, Query, Request
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

from cellctl.hmi.answers.calibrations import CellCalibrations
from cellctl.hmi.answers.recall import (
    CalibrationRecall,
    RunBehind,
    SerialRecall,
    calibration_recall,
    run_behind,
)
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.parameters import MOST, CalibrationId
from cellctl.hmi.visitors.access import Asked
from cellctl.hmi.words.languages import Language
from cellctl.records.entries import RunRecord
from cellctl.records.parts import RUNS_OF_A_PART
from cellctl.records.run_filter import RunFilter
from cellctl.records.store import RunStore

router = APIRouter(prefix="/recall", tags=["records"])


class Stretch(BaseModel):
    """Which runs of those that used the calibration, and how many of them."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    limit: Annotated[int, Field(ge=1, le=5000)] = 1000
    """Most runs of one answer."""
    before: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """The last number of the answer before."""
    since: AwareDatetime | None = None
    """Started then or later."""
    until: AwareDatetime | None = None
    """Started before."""


@router.get("/calibrations/{id}")
async def used(
    request: Request,
    identity: CalibrationId,
    _visitor: Asked,
    stretch: Annotated[Stretch, Query()],
) -> CalibrationRecall:
    """All runs that used a calibration, with the serial numbers of their parts.

    404 when neither the records nor any run of this stretch have it.
    """
    parts = request.app.state.parts
    asked = stretch.model_dump(exclude={"limit"})
    # One more than is answered says whether there are more.
    runs = await parts.archive.listed(RunFilter(calibration=identity, **asked), stretch.limit + 1)
    kept = await parts.archive.ask(lambda store: store.calibration(identity))
    if kept is None and not runs:
        raise Problem(404, "calibration-unknown", "no run used a calibration of this id")
    told = None if kept is None else CellCalibrations(parts.hub.description).told(kept)
    more = len(runs) > stretch.limit
    return calibration_recall(runs[: stretch.limit], told, more=more)


@router.get("/serials/{serial}")
async def behind(
    request: Request,
    serial: Annotated[str, Path(max_length=24, description="Serial number of the part.")],
    _visitor: Asked,
    language: Language,
) -> SerialRecall:
    """What stands behind a part: its runs, and those of parts that were joined to it.

    Each with the calibrations that it used, as they are today, and whether it is as it was sealed.
    At most the newest 100 runs of each sort; 404 when there is none.
    """
    parts = request.app.state.parts
    cell = CellCalibrations(parts.hub.description)

    def read(store: RunStore) -> tuple[RunBehind, ...]:
        heads = store.runs(RUNS_OF_A_PART, serial=serial)
        heads += store.runs(RUNS_OF_A_PART, mate_serial=serial)
        numbers = sorted({head.number for head in heads}, reverse=True)
        records = [store.run(number) for number in numbers]
        used = {one for record in records for one in record.head.calibration_ids.values()}
        kept = {one.id: one for one in map(store.calibration, used) if one is not None}
        return tuple(
            run_behind(record, kept, cell, language, as_sealed=_as_sealed(store, record))
            for record in records
        )

    runs = await parts.archive.ask(read)
    if not runs:
        raise Problem(404, "serial-unknown", "no run has a part of this serial number")
    return SerialRecall(serial=serial, runs=runs)


def _as_sealed(store: RunStore, record: RunRecord) -> bool | None:
    # By the result and not by the seal: a closed run whose seal is gone is not as it was sealed.
    return store.is_as_sealed(record.head.number) if record.head.result else None
