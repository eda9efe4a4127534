"""What the document of the API (OpenAPI) says of it as a whole."""

from collections.abc import Iterable
from typing import Any

from fastapi.routing import APIRoute
from fastapi.security import APIKeyCookie, HTTPBearer
from starlette.routing import BaseRoute

COOKIE = "__Host-cellctl"
DESCRIPTION = """\
The HTTP API of one cell. `docs/http-api.md` of cellctl is its manual.

It is no safety function. Commands go to the cell by one way, `POST /commands`, and the cell decides
upon each; everything else only reads. Whoever reads the live view takes `/events`.

Errors are problem details (RFC 9457): `type` begins with `urn:cellctl:`; `reject_code` is that of a
refused command, `fault` the number of a fault. Keys may be added to an answer: pass over those that
you do not know. No number is NaN: what is not known is null. Times are ISO 8601 with their zone.
"""
TAGS: list[dict[str, Any]] = [
    {"name": "live", "description": "The cell at this moment, as it pushes it to the page."},
    {"name": "commands", "description": "What the cell is asked to do, and what became of it."},
    {"name": "alarms", "description": "Faults and warnings, each time that they came."},
    {"name": "records", "description": "Runs with their files, recall, and who did what."},
    {"name": "calibrations", "description": "Calibrations, those that are replaced included."},
    {"name": "procedures", "description": "The procedures of Maintenance."},
    {"name": "session", "description": "Who asks."},
]
BEARER = HTTPBearer(
    scheme_name="token",
    auto_error=False,
    description="Of a program: `[[tokens]]` of the page's settings. It is at no panel.",
)
SESSION = APIKeyCookie(
    name=COOKIE,
    scheme_name="session",
    auto_error=False,
    description="Of a person: `POST /session` sets it.",
)


def worded(routes: Iterable[BaseRoute]) -> None:
    """Have each operation titled by the first line of its text, not by the name of a function."""
    for route in routes:
        if isinstance(route, APIRoute):
            # Two backticks are our docstrings', one is the document's.
            route.description = route.description.replace("``", "`")
            route.summary = route.description.partition("\n")[0].rstrip(".")


def operation_id(route: APIRoute) -> str:
    """Name of an operation for programs that are made of the document: ``get_runs_number``."""
    (method,) = route.methods or {""}
    path = route.path_format.removeprefix("/api/v1/")
    words = "".join(c if c.isalnum() else " " for c in path).split()
    return "_".join([method.lower(), *words])
