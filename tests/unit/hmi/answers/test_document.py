"""The document of the API has a text for everything, and the manual names every address."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cellctl.hmi.app import routes
from cellctl.hmi.problems import MEDIA_TYPE
from cellctl.hmi.settings import PageSettings

MANUAL = Path(__file__).parents[4] / "docs/http-api.md"
Document = dict[str, Any]
OPEN = {"/version", "/session"}
"""What nobody has to sign in for."""


@pytest.fixture(scope="module")
def document() -> Document:
    return routes(PageSettings()).openapi()


def operations(document: Document) -> Iterator[tuple[str, str, Document]]:
    for path, methods in document["paths"].items():
        for method, one in methods.items():
            yield path.removeprefix("/api/v1"), method.upper(), one


def test_every_operation_and_parameter_has_words(document: Document) -> None:
    assert document["openapi"] == "3.1.0"
    known = {tag["name"] for tag in document["tags"]}
    names = []
    for path, method, one in operations(document):
        where = f"{method} {path}"
        assert one["summary"], where
        assert one["description"], where
        assert "``" not in one["description"], where
        assert set(one["tags"]) <= known, where
        for parameter in one.get("parameters", ()):
            assert parameter.get("description"), (where, parameter["name"])
        names.append(one["operationId"])
    assert len(set(names)) == len(names), "programs are made of these names"


def test_every_refusal_is_a_problem(document: Document) -> None:
    for path, _, one in operations(document):
        for status in ("4XX", "5XX"):
            assert list(one["responses"][status]["content"]) == [MEDIA_TYPE], path
        # A model of FastAPI's own that no answer here has.
        assert "422" not in one["responses"], path


def test_it_says_what_is_signed_in_for(document: Document) -> None:
    schemes = {"session", "token"}
    assert set(document["components"]["securitySchemes"]) == schemes
    for path, method, one in operations(document):
        asked = {name for scheme in one.get("security", ()) for name in scheme}
        signs = path in OPEN and (path, method) != ("/session", "GET")
        assert asked == (set() if signs else schemes), (method, path)


def test_the_manual_names_every_address_and_no_other(document: Document) -> None:
    real = {
        f"{method} {re.sub(r'{[^}]+}', '{}', path)}" for path, method, _ in operations(document)
    }
    rows = re.findall(r"^\| `(GET|POST|DELETE) (/[^`?]*)", MANUAL.read_text("utf-8"), re.MULTILINE)
    written = {f"{method} {re.sub(r'{[^}]+}', '{}', path)}" for method, path in rows}
    # The document does not describe itself.
    assert written == real | {"GET /openapi.json"}
