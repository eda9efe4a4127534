"""The registers of the line PLC. Nothing here can be written."""

from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Request

from cellctl.hmi.answers.line import Register, RegisterList, register_list
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.live import fresh
from cellctl.hmi.visitors.access import Asked

router = APIRouter(prefix="/plc", tags=["live"])
Name = Annotated[str, Path(description="Name of the item in the register map, such as `state`.")]
Writer = Annotated[
    Literal["cell", "line"] | None,
    Query(description="`cell` for the input registers alone, `line` for the holding registers."),
]


@router.get("/registers")
async def registers(request: Request, _visitor: Asked, writer: Writer = None) -> RegisterList:
    """The register map with its values as the cell holds them, in the order of the map.

    503 when the cell has not said anything lately.
    """
    snapshot = fresh(request)
    found = (one for one in _all(request) if writer in (None, one.writer))
    return register_list(snapshot, tuple(found))


@router.get("/registers/{name}")
async def register(request: Request, name: Name, _visitor: Asked) -> Register:
    """One item of the register map by its name; 404 when there is none."""
    fresh(request)
    found = next((one for one in _all(request) if one.name == name), None)
    if found is None:
        raise Problem(404, "register-unknown", "the register map has no item of this name")
    return found


def _all(request: Request) -> tuple[Register, ...]:
    description = request.app.state.parts.hub.description
    return tuple(Register(**one) for one in description.get("registers", ()))
