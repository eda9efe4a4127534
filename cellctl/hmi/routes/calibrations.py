"""Calibrations of the records: how they follow each other, and what each one says."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, ConfigDict, Field

from cellctl.hmi.answers.calibrations import CalibrationList, CalibrationRecord, CellCalibrations
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.parameters import CalibrationId
from cellctl.hmi.visitors.access import Asked

router = APIRouter(tags=["calibrations"])


class CalibrationSearch(BaseModel):
    """Which calibrations, and how many of them."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    limit: Annotated[int, Field(ge=1, le=500)] = 100
    """Most calibrations of one answer."""
    kind: Annotated[str, Field(max_length=80)] = ""
    """Such as `head_1`: how its figures have moved over the years."""


@router.get("/calibrations")
async def calibrations(
    request: Request, _visitor: Asked, search: Annotated[CalibrationSearch, Query()]
) -> CalibrationList:
    """Every calibration that a procedure has stored or a run has used, the newest first.

    `/description` has those that the cell has now, missing ones included.
    """
    parts = request.app.state.parts
    kept = await parts.archive.ask(lambda store: store.calibrations(search.kind, search.limit))
    cell = CellCalibrations(parts.hub.description)
    return CalibrationList(calibrations=tuple(cell.told(one) for one in kept))


@router.get("/calibrations/{id}")
async def calibration(
    request: Request, identity: CalibrationId, _visitor: Asked
) -> CalibrationRecord:
    """One calibration with its whole content; 404 when the records do not have it."""
    parts = request.app.state.parts
    kept = await parts.archive.ask(lambda store: store.calibration(identity))
    if kept is None:
        raise Problem(404, "calibration-unknown", "the records have no calibration of this id")
    return CellCalibrations(parts.hub.description).record(kept)
