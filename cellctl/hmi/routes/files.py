"""The page itself: a handful of files that come with the package."""

import gzip
import hashlib
import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

from fastapi import APIRouter, Request
from fastapi.responses import Response

from cellctl.hmi.problems import Problem
from cellctl.hmi.words.page_words import page_words
from cellctl.translations import LANGUAGES

router = APIRouter(include_in_schema=False)
_TYPES = {
    "css": "text/css",
    "html": "text/html",
    "js": "text/javascript",
    "json": "application/json",
    "svg": "image/svg+xml",
}


@dataclass(frozen=True, slots=True)
class PageFile:
    """A file of the page as it is sent."""

    media_type: str
    data: bytes
    packed: bytes
    """The same by gzip: the Chinese of all faults is 100 kB, and a third of it packed."""
    tag: str


@router.get("/")
@router.get("/page/{name}")
async def file(request: Request, name: str = "index.html") -> Response:
    """One of them. The browser asks each time whether it has changed: they change together."""
    found = _files().get(name)
    if found is None:
        raise Problem(404, "file-unknown", "there is no such file")
    packed = "gzip" in request.headers.get("accept-encoding", "")
    # What is packed is another representation, which has a tag of its own (RFC 9110, 8.8.3).
    etag = f'"{found.tag}-gzip"' if packed else f'"{found.tag}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
    if request.headers.get("if-none-match") == etag:
        return Response(status_code=304, headers=headers)
    if packed:
        headers["Content-Encoding"] = "gzip"
    data = found.packed if packed else found.data
    return Response(data, media_type=found.media_type, headers=headers)


@cache
def _files() -> dict[str, PageFile]:
    found = {}
    words = {f"texts.{language}.json": language for language in LANGUAGES}
    for path in resources.files("cellctl.hmi").joinpath("page").iterdir():
        media_type = _TYPES.get(path.name.rpartition(".")[2])
        if media_type is not None:
            data = path.read_bytes()
            if path.name in words:
                data = json.dumps(page_words(words[path.name]), ensure_ascii=False).encode()
            tag = hashlib.sha256(data).hexdigest()[:32]
            found[path.name] = PageFile(media_type, data, gzip.compress(data), tag)
    return found
