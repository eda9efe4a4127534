"""The procedures of Maintenance, as the cell describes them."""

from typing import Annotated, Any

from fastapi import APIRouter, Path, Request

from cellctl.hmi.answers.procedures import ProcedureList, ProcedureTold, procedure_told
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.live import fresh
from cellctl.hmi.visitors.access import Asked
from cellctl.hmi.words.languages import Language
from cellctl.hmi.words.spoken import description_in, snapshot_in

router = APIRouter(tags=["procedures"])


@router.get("/procedures")
async def procedures(request: Request, _visitor: Asked, language: Language) -> ProcedureList:
    """Every procedure of this cell with its guide, what it renews, and where it stands.

    503 when the cell has not said anything lately.

    `POST /commands` starts one, and obeys Hold, Stop and Abort while it is under way.
    """
    return ProcedureList(procedures=_told(request, language))


@router.get("/procedures/{number}")
async def procedure(
    request: Request,
    number: Annotated[int, Path(description="Number of the procedure.")],
    _visitor: Asked,
    language: Language,
) -> ProcedureTold:
    """One procedure by its number; 404 when this cell does not have it."""
    found = (one for one in _told(request, language) if one.number == number)
    one = next(found, None)
    if one is None:
        raise Problem(404, "procedure-unknown", f"this cell has no procedure {number}")
    return one


def _told(request: Request, language: str) -> tuple[ProcedureTold, ...]:
    snapshot = snapshot_in(language, fresh(request))
    known: dict[str, Any] = request.app.state.parts.hub.description
    description = description_in(language, known)
    listed = description.get("procedures", ())
    return tuple(procedure_told(one, description, snapshot) for one in listed)
