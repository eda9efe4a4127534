"""Whatever is asked of any address of the document: an answer, and never a failure of our own."""

import asyncio
import hashlib
import json
import shutil
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import quote, urlencode

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cellctl.hmi.problems import MEDIA_TYPE
from cellctl.hmi.routes.exports import RunExporter
from cellctl.hmi.visitors.rates import RateLimit
from tests.unit.hmi.http_client import Reply
from tests.unit.hmi.in_process import Api, settings_for
from tests.unit.hmi.routes.conftest import NEW

TOKEN = "a-token-that-maintains"
KNOWN = ("1", "2", "101", "512", "DECK-1", NEW.id, "state", "key-taken-1", "good", "true", "head_1")
"""What leads somewhere: most other texts are refused before anything is looked up."""
ODD = (
    "",
    "0",
    "-1",
    "9" * 25,
    "1e400",
    "NaN",
    "..",
    "%00",
    "\0",
    "'; DROP TABLE runs; --",
    "\ud7ff",
)
TEXT = st.sampled_from(KNOWN) | st.sampled_from(ODD) | st.text(max_size=30)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=8,
)
REQUESTS = ("start", "procedure", "mode", "acknowledge", "reset", "abort", "dance")
COMMAND = st.fixed_dictionaries(
    {"request": st.sampled_from(REQUESTS)},
    optional={
        "serial": TEXT,
        "recipe": TEXT,
        "number": st.integers(),
        "mode": st.sampled_from(["manual", "party"]),
        "dry_run": st.booleans(),
    },
)
BODY = st.fixed_dictionaries(
    {"command": COMMAND | JSON}, optional={"decision": JSON, "reason": st.text(), "more": JSON}
)
SIGN_IN = st.fixed_dictionaries({"name": TEXT, "pin": TEXT})


class _QuickExporter(RunExporter):
    """Every export is made at once, and is empty."""

    @asynccontextmanager
    async def made(
        self, number: int, form: tuple[str, ...], name: str, limit_s: float
    ) -> AsyncIterator[Path]:
        folder = self._data_dir.parent / "export"
        for file in (folder / "report" / "report.html", folder / "record" / "run.json"):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(f"{number} {form} {limit_s}")
        (folder / name).is_dir() or (folder / name).write_bytes(b"")
        yield folder


@dataclass
class Asked:
    """The API with an event loop of its own."""

    api: Api
    loop: asyncio.Runner

    def answer(self, method: str, path: str, body: bytes, headers: dict[str, str]) -> Reply:
        async def ask() -> Reply:
            await self.api.hear()
            return await self.api.ask(method, path, body, **headers)

        return self.loop.run(ask())


@pytest.fixture(scope="module")
def asked(filled: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Asked]:
    store = Path(shutil.copytree(filled, tmp_path_factory.mktemp("any") / "store"))
    token = {
        "name": "mes",
        "role": "maintain",
        "sha256": hashlib.sha256(TOKEN.encode()).hexdigest(),
        "expires": "2999-12-31",
    }
    api = Api(settings_for(store, tokens=[token]))
    unlimited = RateLimit(10**9, 60.0)
    api.parts = replace(api.parts, exporter=_QuickExporter(store), commands=unlimited)
    api.app.state.parts = api.parts
    with asyncio.Runner() as loop:
        yield Asked(api, loop)


def operations(api: Api) -> list[tuple[str, str, list[str]]]:
    """Method, path and names of the query of everything in the document but the stream."""
    found = []
    for path, methods in api.app.openapi()["paths"].items():
        for method, one in methods.items():
            if not path.endswith("/events"):
                query = [p["name"] for p in one.get("parameters", ()) if p["in"] == "query"]
                found.append((method.upper(), path, query))
    return found


def no_constant(name: str) -> NoReturn:
    raise AssertionError(f"{name} in an answer: no browser can read that")


def told(reply: Reply) -> Any:
    """The JSON of an answer, without the numbers that JSON does not have."""
    return json.loads(reply.body, parse_constant=no_constant)


@given(data=st.data())
def test_any_request_has_an_answer(asked: Asked, data: st.DataObject) -> None:
    method, path, names = data.draw(st.sampled_from(operations(asked.api)))
    while "{" in path:
        before, _, rest = path.partition("{")
        path = before + quote(data.draw(TEXT), safe="") + rest.partition("}")[2]
    pairs = data.draw(st.lists(st.tuples(st.sampled_from([*names, "unknown"]), TEXT), max_size=3))
    body = b""
    if method == "POST":
        content = data.draw(BODY | SIGN_IN | JSON)
        body = data.draw(st.binary(max_size=40) | st.just(json.dumps(content).encode()))
    headers = {"Idempotency_Key": data.draw(st.sampled_from(["test-key-1", "x", "ö"]))}
    headers |= {"Accept_Language": data.draw(st.sampled_from(["", "zh", "de;q=x, en", ";;q=,"]))}
    if data.draw(st.booleans()):
        headers["Authorization"] = f"Bearer {TOKEN}"
    reply = asked.answer(method, f"{path}?{urlencode(pairs)}", body, headers)
    assert reply.status < 500, reply.body
    if reply.status >= 400:
        assert reply.headers["content-type"] == MEDIA_TYPE
        problem = told(reply)
        assert problem["status"] == reply.status
        assert {"type", "title", "detail", "instance"} <= problem.keys()
    elif reply.headers["content-type"].startswith("application/json"):
        told(reply)


@pytest.mark.parametrize("path", ["/api/v1/commands/", "/api/v1/runs/", "/api/v1", "/api/v1/"])
def test_an_address_that_is_nearly_one_leads_nowhere(asked: Asked, path: str) -> None:
    reply = asked.answer("GET", path, b"", {})
    assert (reply.status, reply.headers["content-type"]) == (404, MEDIA_TYPE)


@pytest.mark.parametrize("method", ["PUT", "PATCH", "TRACE", "HEAD"])
def test_no_address_has_another_method(asked: Asked, method: str) -> None:
    for path in {path for _, path, _ in operations(asked.api)}:
        reply = asked.answer(method, path, b"", {})
        assert reply.status == 405, path
        assert reply.headers["allow"]
