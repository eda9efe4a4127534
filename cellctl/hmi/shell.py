"""What every answer has around it: allowed hosts, a limit on bodies, headers for the browser."""

import asyncio
from collections.abc import Set

from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from cellctl.hmi.problems import answer
from cellctl.hmi.visitors.hosts import host_name

BODY_LIMIT = 64 * 1024
BODY_S = 10.0
"""A body that takes longer holds one of the connections that others need."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
)


class Shell:
    """ASGI, and no ``BaseHTTPMiddleware``: that one queues the events of a slow client for ever."""

    def __init__(self, app: ASGIApp, hosts: Set[str], *, body_s: float = BODY_S) -> None:
        self._app = app
        self._hosts = hosts
        self._body_s = body_s

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = dict(scope["headers"])
        # Against DNS rebinding: a foreign name that leads here is not ours to answer.
        if host_name(headers.get(b"host", b"").decode("latin-1")) not in self._hosts:
            refused = answer(Request(scope), 421, "host", "this name is not served here")
            await refused(scope, receive, send)
            return
        length = headers.get(b"content-length", b"0")
        if not length.isdigit() or int(length) > BODY_LIMIT or b"transfer-encoding" in headers:
            refused = answer(Request(scope), 413, "body", "the body is too long")
            await refused(scope, receive, send)
            return

        try:
            async with asyncio.timeout(self._body_s):
                body = await _body(receive) if int(length) else None
        except TimeoutError:
            refused = answer(Request(scope), 408, "body", "the body does not come")
            await refused(scope, receive, send)
            return

        async def whole() -> Message:
            nonlocal body
            if body is None:
                return await receive()
            message, body = body, None
            return message

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name for name, _ in message["headers"]}
                message["headers"] = [
                    *message["headers"],
                    *(pair for pair in HEADERS if pair[0] not in given),
                ]
            await send(message)

        await self._app(scope, whole, with_headers)


async def _body(receive: Receive) -> Message:
    """The whole body as one message; that of a client who has gone when it goes meanwhile."""
    pieces = []
    while True:
        message = await receive()
        if message["type"] != "http.request":
            return message
        pieces.append(message.get("body", b""))
        if not message.get("more_body", False):
            return {"type": "http.request", "body": b"".join(pieces), "more_body": False}
