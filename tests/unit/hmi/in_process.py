"""The API without server, browser and daemon: requests go straight into the application."""

import asyncio
import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from starlette.types import ASGIApp, Message

from cellctl.api.local_socket.live_feed import as_line
from cellctl.api.local_socket.messages import Answer, PageCommand, Taken
from cellctl.clock import now_s
from cellctl.hmi.app import Parts, routes
from cellctl.hmi.daemon_link import DaemonLink
from cellctl.hmi.settings import LOOPBACK, PageSettings
from cellctl.hmi.shell import Shell
from tests.unit.hmi.http_client import Reply
from tests.unit.hmi.scripted_daemon import PaperDaemon

HOST = "127.0.0.1:8080"


class _Link(DaemonLink):
    """Takes every command, without a socket."""

    def __init__(self) -> None:
        self.asked: list[PageCommand] = []
        self.answer: Answer = Taken(state="EXECUTE")

    async def ask(self, command: PageCommand) -> Answer:
        self.asked.append(command)
        return self.answer


def lasting_s() -> float:
    """The time of a snapshot that is not old before the test has ended, however busy the PC."""
    return now_s() + 600.0


@dataclass
class Api:
    """The application with its own daemon, which says what it is told to."""

    settings: PageSettings
    link: _Link = field(default_factory=_Link)

    def __post_init__(self) -> None:
        self.app = routes(self.settings)
        parts: Parts = self.app.state.parts
        self.parts = self.app.state.parts = replace(parts, link=self.link)
        self._served = Shell(self.app, LOOPBACK)

    async def hear(self, **changes: Any) -> None:
        """Have the daemon say a snapshot with these changes, and its description."""
        paper = PaperDaemon()
        await self.parts.hub.take(as_line({**paper.snapshot, **changes, "mono_s": lasting_s()}))
        await self.parts.hub.take(as_line({"kind": "description", **paper.description}))

    async def describe(self, **changes: Any) -> None:
        """Have the daemon describe the cell with these changes."""
        described = PaperDaemon().description | changes
        await self.parts.hub.take(as_line({"kind": "description", **described}))

    async def get(self, path: str, **headers: str) -> Reply:
        return await self.ask("GET", f"/api/v1/{path}", b"", **headers)

    async def ask(self, method: str, path: str, body: bytes = b"", **headers: str) -> Reply:
        """Headers with underscores for dashes."""
        given = {"host": HOST, "content-type": "application/json", "origin": f"http://{HOST}"}
        given |= {"content-length": str(len(body))}
        given |= {name.replace("_", "-").lower(): value for name, value in headers.items()}
        raw, _, query = path.partition("?")
        scope = {
            "type": "http",
            "http_version": "1.1",
            "method": method,
            "scheme": "http",
            "path": unquote(raw),
            "raw_path": raw.encode(),
            "query_string": query.encode(),
            "headers": [(n.encode("latin-1"), v.encode("latin-1")) for n, v in given.items()],
            "client": ("127.0.0.1", 50000),
            "server": ("127.0.0.1", 8080),
        }
        return await answered(self._served, scope, body)


async def answered(
    app: ASGIApp, scope: dict[str, Any], body: bytes = b"", *, stays: bool = True
) -> Reply:
    """What an application answers to one request; raises what the application raises.

    ``stays``: whoever asks waits for the whole answer, and has not gone when it begins.
    """
    waiting: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]
    sent: list[Message] = []

    async def receive() -> Message:
        if waiting:
            return waiting.pop()
        if stays:
            await asyncio.Event().wait()
        return {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        sent.append(message)

    await app(scope, receive, send)
    start, *pieces = sent
    headers = {name.decode().lower(): value.decode() for name, value in start["headers"]}
    return Reply(start["status"], headers, b"".join(one.get("body", b"") for one in pieces))


def bodied(content: Any) -> bytes:
    """A body of JSON."""
    return json.dumps(content).encode()


def settings_for(store: Path, secret: str = "", **changes: Any) -> PageSettings:
    """Settings with anna (operate), boris (maintain) and vera (view)."""
    people = [
        {"name": name, "role": role, "secret": secret}
        for name, role in (("anna", "operate"), ("boris", "maintain"), ("vera", "view"))
    ]
    return PageSettings.model_validate({"data_dir": str(store), "people": people, **changes})
