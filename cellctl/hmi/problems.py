"""Errors as problem details (RFC 9457)."""

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from cellctl.errors import CellError
from cellctl.errors.records.store import ArtefactDamaged, RunUnknown
from cellctl.hmi.words.languages import headers_of, language_of
from cellctl.hmi.words.page_words import refusal
from cellctl.translations import fault_words, spoken

MEDIA_TYPE = "application/problem+json"
RESPONSES: dict[int | str, dict[str, Any]] = {
    "4XX": {"description": "Problem details (RFC 9457)", "content": {MEDIA_TYPE: {}}},
    "5XX": {"description": "Problem details (RFC 9457)", "content": {MEDIA_TYPE: {}}},
}


class Problem(Exception):
    """An answer that is a problem; ``members`` go into it as they are."""

    def __init__(self, status: int, kind: str, detail: str, **members: Any) -> None:
        super().__init__(detail)
        self.status = status
        self.kind = kind
        self.detail = detail
        self.members = members
        self.headers: dict[str, str] = {}

    def later(self, seconds: float) -> "Problem":
        """The problem with the time after which it is worth trying again."""
        self.headers["Retry-After"] = str(max(1, round(seconds)))
        return self


def add_handlers(app: FastAPI) -> None:
    """Every error of the API leaves as problem details."""
    app.add_exception_handler(Problem, _problem)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(CellError, _fault)
    app.add_exception_handler(Exception, _unexpected)


def answer(
    request: Request, status: int, kind: str, detail: str, members: dict[str, Any] | None = None
) -> JSONResponse:
    """The problem as an answer."""
    content = {
        "type": f"urn:cellctl:{kind}",
        "title": HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
        "instance": request.url.path,
        **(members or {}),
    }
    # RFC 9110, 15.5.2. A scheme of a browser's own would have it ask for a name by itself.
    headers = {"WWW-Authenticate": "Bearer"} if status == HTTPStatus.UNAUTHORIZED else None
    return JSONResponse(content, status, headers, media_type=MEDIA_TYPE)


async def _problem(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, Problem)
    language, code = language_of(request), error.members.get("reject_code")
    detail = spoken(error.detail, language)
    if code is not None:
        detail = refusal(code, detail, language)
    response = answer(request, error.status, error.kind, detail, error.members)
    response.headers.update({**headers_of(language), **error.headers})
    return response


async def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    response = answer(request, error.status_code, "http", str(error.detail))
    response.headers.update(error.headers or {})  # such as which methods there are
    return response


async def _unexpected(request: Request, _error: Exception) -> JSONResponse:
    # What went wrong is in the log, where no stranger reads it.
    return answer(request, 500, "unexpected", "a defect of the page's process; see its log")


async def _invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    # Without the input: what a client has sent does not come back to it.
    errors = [
        {"place": ".".join(str(part) for part in one["loc"]), "problem": one["msg"]}
        for one in error.errors()
    ]
    return answer(request, 422, "invalid", "the request is not valid", {"errors": errors})


async def _fault(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, CellError)
    status = 503
    if isinstance(error, RunUnknown):
        status = 404
    elif isinstance(error, ArtefactDamaged):
        status = 410
    language = language_of(request)
    words = fault_words(type(error), language)
    members = {"fault": error.number, "cause": words.cause, "remedy": words.remedy}
    detail = spoken(str(error), language)
    response = answer(request, status, f"fault-{error.number}", detail, members)
    response.headers.update(headers_of(language))
    return response
