"""What goes wrong leaves as problem details, a defect of our own included."""

import json

import pytest
from fastapi import FastAPI
from starlette.types import Message

from cellctl.hmi.problems import MEDIA_TYPE, add_handlers


async def test_a_defect_is_a_problem_that_tells_no_stranger_what_it_is() -> None:
    app = FastAPI()
    add_handlers(app)

    @app.get("/broken")
    async def broken() -> None:
        raise RuntimeError("the secret of anna")

    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {
        "type": "http",
        "http_version": "1.1",
        "method": "GET",
        "scheme": "http",
        "path": "/broken",
        "raw_path": b"/broken",
        "query_string": b"",
        "headers": [],
    }
    # It goes on to the server, which logs it.
    with pytest.raises(RuntimeError):
        await app(scope, receive, send)
    start, body = sent
    assert start["status"] == 500
    assert (b"content-type", MEDIA_TYPE.encode()) in start["headers"]
    told = json.loads(body["body"])
    assert (told["type"], told["status"]) == ("urn:cellctl:unexpected", 500)
    assert "anna" not in json.dumps(told)
