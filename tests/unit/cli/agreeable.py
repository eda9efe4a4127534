"""A daemon that takes every command and is there at once; it listens in a thread of its own."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cellctl.api.local_socket.messages import (
    Answer,
    GivenCommand,
    Refused,
    Request,
    StatusAnswer,
    StatusRequest,
    Taken,
)
from cellctl.api.local_socket.report import FaultReport, StatusReport
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.clock import now_s
from cellctl.packml.unit_command import MOST_AGE_S

_LEADS_TO = {
    "clear": "STOPPED",
    "reset": "IDLE",
    "hold": "HELD",
    "unhold": "EXECUTE",
    "stop": "STOPPED",
    "abort": "ABORTED",
    "start": "COMPLETED",
    "procedure": "COMPLETED",
}
AT_REST: dict[str, Any] = {
    "cell": "fake-cell",
    "simulated": True,
    "state": "STOPPED",
    "state_requested": "STOPPED",
    "mode": "PRODUCTION",
    "control": "shared",
    "line_alive": False,
    "connected": True,
    "ready": False,
    "hold_requested": False,
    "step": "",
    "iteration": 0,
    "errors": (),
    "forces": (),
    "permitted": {"reset": "", "start": "command not allowed in this state"},
    "faults": (),
    "alarms": (),
    "guard_trip": "",
    "links": {"robots.main": "", "guard": ""},
    "calibrations": (),
    "result": "good",
    "last_run": None,
    "good_parts": 0,
    "records": "",
    "data_dir": "runs/absent",
}


@dataclass
class Agreeable:
    """What it says it is can be changed, and whether it refuses."""

    shows: dict[str, Any] = field(default_factory=lambda: dict(AT_REST))
    asked: list[Request] = field(default_factory=list)
    refusal: Refused | None = None
    leads_to: dict[str, str] = field(default_factory=lambda: dict(_LEADS_TO))
    comes_with: dict[str, tuple[FaultReport, ...]] = field(default_factory=dict)
    """Alarms that a command leads to."""
    on_its_way_to: str = ""
    """Another state than it shows, where it never arrives."""

    async def follow(self, _writer: asyncio.StreamWriter) -> None:
        raise AssertionError("no command of the terminal follows")

    async def handle(self, request: Request, _uid: int) -> Answer:
        if isinstance(request, StatusRequest):
            return StatusAnswer(report=StatusReport(**self.shows))
        if isinstance(request, GivenCommand):
            assert 0.0 <= now_s() - request.given_s < MOST_AGE_S
            request = request.command
        self.asked.append(request)
        if self.refusal is not None:
            return self.refusal
        state = self.leads_to.get(request.request, self.shows["state"])
        self.shows["alarms"] = self.comes_with.get(request.request, self.shows["alarms"])
        self.shows |= {"state": state, "state_requested": self.on_its_way_to or state}
        return Taken(state=state)


@contextmanager
def listening(path: Path, daemon: Agreeable) -> Iterator[None]:
    """The daemon on a socket."""
    up, down = threading.Event(), asyncio.Event()
    loop = asyncio.new_event_loop()

    async def serve() -> None:
        server = LocalServer(SocketFile(path, ""), daemon.handle, daemon.follow)
        await server.start()
        up.set()
        await down.wait()
        await server.stop()

    thread = threading.Thread(target=loop.run_until_complete, args=(serve(),))
    thread.start()
    assert up.wait(5)
    try:
        yield
    finally:
        loop.call_soon_threadsafe(down.set)
        thread.join(5)
        loop.close()
