"""What every answer has around it."""

import asyncio
from typing import Any

import pytest
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from cellctl.hmi.problems import MEDIA_TYPE
from cellctl.hmi.shell import Shell


async def echo(scope: Scope, receive: Receive, send: Send) -> None:
    """Answers with the body, and says then whether the client has gone."""
    body = await Request(scope, receive).body()
    await PlainTextResponse(body)(scope, receive, send)


def scope(length: int) -> dict[str, Any]:
    headers = [(b"host", b"localhost:8080"), (b"content-length", str(length).encode())]
    return {
        "type": "http",
        "method": "POST",
        "path": "/x",
        "raw_path": b"/x",
        "query_string": b"",
        "scheme": "http",
        "server": ("localhost", 8080),
        "headers": headers,
    }


async def told(pieces: list[bytes], length: int, body_s: float = 60.0) -> list[Message]:
    """What is sent to a client whose body comes in these pieces, and then no further."""
    waiting = list(pieces)
    sent: list[Message] = []

    async def receive() -> Message:
        if not waiting:
            await asyncio.Event().wait()
        piece = waiting.pop(0)
        return {"type": "http.request", "body": piece, "more_body": piece != pieces[-1]}

    async def send(message: Message) -> None:
        sent.append(message)

    shell = Shell(echo, frozenset({"localhost"}), body_s=body_s)
    await shell(scope(length), receive, send)
    return sent


async def test_a_body_in_pieces_arrives_whole() -> None:
    start, body = await told([b"ab", b"cd"], 4)
    assert (start["status"], body["body"]) == (200, b"abcd")
    headers = {name for name, _ in start["headers"]}
    assert b"content-security-policy" in headers


async def test_a_body_that_does_not_come_holds_no_connection() -> None:
    start, body = await told([], 4, body_s=0.01)
    assert start["status"] == 408
    assert (b"content-type", MEDIA_TYPE.encode()) in start["headers"]
    assert b"urn:cellctl:body" in body["body"]


async def test_of_a_client_that_has_gone_the_application_is_told() -> None:
    async def receive() -> Message:
        return {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        raise AssertionError(message)

    heard: list[str] = []

    async def listening(_scope: Scope, receive: Receive, _send: Send) -> None:
        heard.append((await receive())["type"])

    await Shell(listening, frozenset({"localhost"}))(scope(4), receive, send)
    assert heard == ["http.disconnect"]


@pytest.mark.parametrize("length", [0, 5])
async def test_without_a_body_nothing_is_waited_for(length: int) -> None:
    sent = await told([b"hello"] if length else [b""], length, body_s=0.5)
    assert sent[0]["status"] == 200
