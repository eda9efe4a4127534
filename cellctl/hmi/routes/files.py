"""The page itself: a handful of files that come with the package."""

import hashlib
from functools import cache
from importlib import resources

from fastapi import APIRouter, Request
from fastapi.responses import Response

from cellctl.hmi.problems import Problem

router = APIRouter(include_in_schema=False)
_TYPES = {
    "css": "text/css",
    "html": "text/html",
    "js": "text/javascript",
    "json": "application/json",
    "svg": "image/svg+xml",
}


@router.get("/")
@router.get("/page/{name}")
async def file(request: Request, name: str = "index.html") -> Response:
    """One of them. The browser asks each time whether it has changed: they change together."""
    found = _files().get(name)
    if found is None:
        raise Problem(404, "file-unknown", "there is no such file")
    media_type, data, etag = found
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if request.headers.get("if-none-match") == etag:
        return Response(status_code=304, headers=headers)
    return Response(data, media_type=media_type, headers=headers)


@cache
def _files() -> dict[str, tuple[str, bytes, str]]:
    found = {}
    for path in resources.files("cellctl.hmi").joinpath("page").iterdir():
        media_type = _TYPES.get(path.name.rpartition(".")[2])
        if media_type is not None:
            data = path.read_bytes()
            found[path.name] = (media_type, data, f'"{hashlib.sha256(data).hexdigest()[:32]}"')
    return found
