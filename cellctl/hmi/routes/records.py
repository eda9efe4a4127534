"""What the cell did: runs, their files, the audit log."""

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

from cellctl.api.local_socket.messages import Role
from cellctl.hmi.problems import Problem
from cellctl.hmi.routes.parameters import MOST, RunNumber
from cellctl.hmi.visitors.access import Asked
from cellctl.hmi.words.languages import Language
from cellctl.hmi.words.spoken import run_in
from cellctl.records.run_filter import RunFilter

router = APIRouter(tags=["records"])
_SHOWN = frozenset({"image/png", "image/jpeg"})
"""What a browser may show; everything else it may only keep."""


FileName = Annotated[str, Path(description="Name of the file, as the run lists it.")]


class RunSearch(BaseModel):
    """Which runs, and how many of them."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    limit: Annotated[int, Field(ge=1, le=200)] = 50
    """Most runs of one answer."""
    before: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """The last number of the page before."""
    serial: Annotated[str, Field(max_length=24)] = ""
    """Its beginning."""
    recipe: Annotated[str, Field(max_length=80)] = ""
    """Its name."""
    operator: Annotated[str, Field(max_length=80)] = ""
    """Name or order, as the run has it."""
    result: Annotated[str, Field(max_length=16)] = ""
    """Such as `good`, or `open`."""
    fault: Annotated[int | None, Field(ge=1, le=MOST)] = None
    """Number of a fault that ended the run, or of an alarm that it raised."""
    calibration: Annotated[str, Field(max_length=80)] = ""
    """Identity of a calibration that the runs used."""
    since: AwareDatetime | None = None
    """Started then or later."""
    until: AwareDatetime | None = None
    """Started before."""

    def wanted(self) -> RunFilter:
        """The same as the records ask for it."""
        asked = self.model_dump(exclude={"limit", "serial"})
        return RunFilter(**asked, serial_begins=self.serial)


@router.get("/runs")
async def runs(
    request: Request, _visitor: Asked, search: Annotated[RunSearch, Query()]
) -> dict[str, Any]:
    """The newest runs, newest first."""
    archive = request.app.state.parts.archive
    return {"runs": await archive.runs(search.wanted(), search.limit)}


@router.get("/runs/{number}")
async def run(
    request: Request, number: RunNumber, _visitor: Asked, language: Language
) -> dict[str, Any]:
    """One run with all its figures."""
    return run_in(language, await request.app.state.parts.archive.run(number))


@router.get("/runs/{number}/artefacts/{name:path}", response_class=Response)
async def artefact(
    request: Request, number: RunNumber, name: FileName, _visitor: Asked
) -> Response:
    """A file of a run; 410 when it is damaged."""
    found = await request.app.state.parts.archive.file(number, name)
    if found is None:
        raise Problem(404, "file-unknown", f"run {number} has no file {name}")
    file, data = found
    etag = f'"{file.sha256}"'
    headers = {"ETag": etag, "Cache-Control": "private, max-age=31536000, immutable"}
    if request.headers.get("if-none-match") == etag:
        return Response(status_code=304, headers=headers)
    # A process may keep files of any type in a record, HTML with scripts among them. Shown from
    # here it would act as this page.
    if file.media_type not in _SHOWN:
        headers["Content-Disposition"] = f'attachment; filename="{file.sha256[:12]}"'
    return Response(data, media_type=file.media_type, headers=headers)


@router.get("/audit")
async def audit(
    request: Request,
    visitor: Asked,
    limit: Annotated[int, Query(ge=1, le=500, description="Most entries of one answer.")] = 100,
) -> dict[str, Any]:
    """Who did what, the newest first; for those who maintain the cell."""
    role: Role = visitor.role
    if role != "maintain":
        raise Problem(403, "role", "needs the role maintain")
    return {"entries": await request.app.state.parts.archive.audit(limit)}
