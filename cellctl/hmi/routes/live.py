"""The cell at this moment."""

from typing import Annotated, Any

from fastapi import APIRouter, Path, Request
from fastapi.responses import StreamingResponse

from cellctl.clock import now_s
from cellctl.fault_catalogue import known_fault
from cellctl.hmi.answers.permissions import Permission, permissions
from cellctl.hmi.problems import Problem
from cellctl.hmi.visitors.access import Asked
from cellctl.hmi.words.languages import Language
from cellctl.hmi.words.spoken import description_in, snapshot_in
from cellctl.translations import fault_words
from cellctl.version import software

router = APIRouter(tags=["live"])
STALE_S = 1.5


@router.get("/status")
async def status(request: Request, _visitor: Asked, language: Language) -> dict[str, Any]:
    """The newest snapshot; 503 when there is none that is fresh."""
    return snapshot_in(language, fresh(request))


def fresh(request: Request) -> dict[str, Any]:
    """The newest snapshot; raises ``Problem`` 503 when it is old, or there is none."""
    hub = request.app.state.parts.hub
    if hub.age_s is None or hub.age_s > STALE_S:
        raise Problem(503, "daemon-away", "the cell has not said anything lately").later(1)
    return dict(hub.snapshot)


@router.get("/description")
async def description(request: Request, _visitor: Asked, language: Language) -> dict[str, Any]:
    """Calibrations, and the recipes and procedures to choose from."""
    return description_in(language, request.app.state.parts.hub.description)


@router.get("/permitted")
async def permitted(request: Request, visitor: Asked, language: Language) -> dict[str, Permission]:
    """By command: code 0 if the cell would take it now from whoever asks, else why not."""
    return permissions(visitor, fresh(request).get("permitted", {}), language)


@router.get("/health")
async def health(request: Request, _visitor: Asked) -> dict[str, Any]:
    """Links of the devices, and of this process to the daemon."""
    parts = request.app.state.parts
    return {
        "daemon_linked": parts.hub.linked,
        "snapshot_age_s": parts.hub.age_s,
        "pages_open": parts.streams.count,
        "links": parts.hub.snapshot.get("links", {}),
        "software": software(),
    }


@router.get("/clock")
async def clock(_visitor: Asked) -> dict[str, float]:
    """The clock of the snapshots, for browsers that find out how old theirs are."""
    return {"mono_s": now_s()}


@router.get("/curve")
async def curve(request: Request, _visitor: Asked) -> dict[str, Any]:
    """Fz in N of each force sensor in the last minute, for a page that was reloaded."""
    return {"points": request.app.state.parts.hub.curve}


@router.get("/faults/{number}")
async def fault(
    number: Annotated[int, Path(description="Number of the fault.")],
    _visitor: Asked,
    language: Language,
) -> dict[str, Any]:
    """One fault of the catalogue, those of installed packages included."""
    found = known_fault(number)
    if found is None:
        raise Problem(404, "fault-unknown", f"there is no F{number:03d}")
    words = fault_words(found, language)
    return {
        "number": found.number,
        "text": words.text,
        "cause": words.cause,
        "remedy": words.remedy,
        "reaction": found.reaction.name.lower(),
    }


@router.get("/version")
async def version() -> dict[str, str]:
    """Of the page's process."""
    return {"version": software()}


@router.get("/events", response_class=StreamingResponse)
async def events(request: Request, visitor: Asked) -> StreamingResponse:
    """Server-sent events ``snapshot``, ``description``, ``link`` and ``beat``."""
    streams = request.app.state.parts.streams
    # Before the response begins: once it streams, its status can no longer be 429.
    streams.admit(visitor.key)
    return StreamingResponse(
        streams.events(visitor.key),
        media_type="text/event-stream",
        # nginx would else collect events until its buffer is full.
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )
