"""A daemon for the page's process: pushes what a test says, and answers as a test says."""

import asyncio
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cellctl.api.local_socket.live_feed import as_line
from cellctl.api.local_socket.messages import Answer, PageCommand, Request, Taken
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile
from cellctl.clock import now_s
from cellctl.hmi.main import TAKE_TIMEOUT_MS, page_server, url_of
from cellctl.hmi.settings import load_settings

PIN = "123456"
NAMES = ("start", "procedure", "reset", "hold", "unhold", "clear", "stop", "abort", "mode")


def snapshot(**changes: Any) -> dict[str, Any]:
    """A cell at rest, with every key that the daemon sends."""
    axes = ("x", "y", "z", "rx", "ry", "rz")
    wrench = [{"axis": name, "unit": "N", "value": 1.5, "limit": None} for name in ("Fx", "Fz")]
    return {
        "kind": "snapshot",
        "decision": 7,
        "cell": "paper cell",
        "simulated": True,
        "state": "IDLE",
        "state_requested": "IDLE",
        "state_s": 3.0,
        "mode": "PRODUCTION",
        "control": "shared",
        "line_alive": False,
        "connected": True,
        "ready": True,
        "hold_requested": False,
        "safe_point_ahead": True,
        "stop_not_confirmed": False,
        "step": {"number": 0, "label": "", "text": ""},
        "pass": 0,
        "run": {"number": 0, "serial": "", "recipe": 0, "result": "none", "good_parts": 4},
        "errors": [{"axis": a, "unit": "mm", "value": None, "limit": None} for a in axes],
        "forces": [
            {
                "sensor": "wrist",
                "age_s": 0.001,
                "stale": False,
                "compensated": True,
                "limit_n": 50.0,
                "trip": "",
                "touch": "",
                "wrench": wrench,
                "peaks": [None] * 6,
            }
        ],
        "daemon": {"loop_late_s": 0.02, "line_beat_age_s": 0.3, "resident_bytes": 200_000_000},
        "guards": {"wrist": {"late_wakeups": 3, "flange_age_s": 0.004}},
        "faults": [],
        "alarms": [],
        "last_command": None,
        "permitted": {name: {"code": 0, "reason": ""} for name in NAMES},
        "links": {"robots.main": ""},
    } | changes


def alarm(number: int, text: str, reaction: str = "abort") -> dict[str, Any]:
    return {
        "number": number,
        "text": f"F{number} {text}",
        "cause": "a cause",
        "remedy": "a remedy",
        "reaction": reaction,
        "since": "2026-01-02T03:04:05.678+00:00",
        "run": 17,
        "times": 1,
        "newest": "2026-01-02T03:04:05.678+00:00",
    }


@dataclass
class PaperDaemon:
    """Its fields may be changed while it runs."""

    snapshot: dict[str, Any] = field(default_factory=snapshot)
    description: dict[str, Any] = field(
        default_factory=lambda: {
            "calibrations": [
                {
                    "kind": "head",
                    "made": "2026-01-02T03:04:05Z",
                    "valid_until": "2036-01-02T03:04:05Z",
                    "problem": "",
                }
            ],
            "recipes": [{"number": 1, "name": "a part"}],
            "procedures": [
                {
                    "number": 101,
                    "name": "calibrate head 1",
                    "set_up": ["The calibration board lies under the head.", "The light is on."],
                    "moves": ["Nothing else moves."],
                    "then": ["Take the board away."],
                    "renews": ["head"],
                },
                {"number": 900, "name": "of a plug-in"},
            ],
            "registers": [
                {
                    "address": 2,
                    "name": "state",
                    "text": "PackML StateCurrent",
                    "unit": "",
                    "writer": "cell",
                    "value": 4,
                },
                {
                    "address": 31,
                    "name": "error_x",
                    "text": "error in x",
                    "unit": "µm",
                    "writer": "cell",
                    "value": None,
                },
            ],
            "last_run": None,
            "records": "",
        }
    )
    answer: Answer = field(default_factory=lambda: Taken(state="EXECUTE"))
    asked: list[PageCommand] = field(default_factory=list)
    silent: bool = False
    """Pushes nothing, as a daemon that is frozen."""
    holds_back: bool = False
    """Answers no command."""

    async def handle(self, request: Request, _uid: int) -> Answer:
        assert isinstance(request, PageCommand)
        self.asked.append(request)
        if self.holds_back:
            await asyncio.sleep(60.0)
        return self.answer

    async def follow(self, writer: asyncio.StreamWriter) -> None:
        described = b""
        while True:
            if not self.silent:
                line = as_line({"kind": "description", **self.description})
                if line != described:
                    writer.write(line)
                    described = line
                writer.write(as_line({**self.snapshot, "mono_s": now_s()}))
                await writer.drain()
            await asyncio.sleep(0.05)


@contextmanager
def serving(path: Path, daemon: PaperDaemon) -> Iterator[None]:
    """The daemon on a socket."""
    up, down = threading.Event(), asyncio.Event()
    loop = asyncio.new_event_loop()

    async def serve() -> None:
        server = LocalServer(SocketFile(path, ""), daemon.handle, daemon.follow)
        await server.start()
        up.set()
        await down.wait()
        for task in asyncio.all_tasks() - {asyncio.current_task()}:
            task.cancel()
        await server.stop()

    thread = threading.Thread(target=loop.run_until_complete, args=(serve(),))
    thread.start()
    assert up.wait(5)
    try:
        yield
    finally:
        loop.call_soon_threadsafe(down.set)
        thread.join(10)
        loop.close()


@contextmanager
def page_thread(settings: Path, take_timeout_ms: int = TAKE_TIMEOUT_MS) -> Iterator[str]:
    """The page's server with these settings in a thread, and its address."""
    found = load_settings(settings)
    server, listener = page_server(found, take_timeout_ms=take_timeout_ms)
    thread = threading.Thread(target=lambda: asyncio.run(server.serve(sockets=[listener])))
    thread.start()
    try:
        yield url_of(listener)
    finally:
        server.should_exit = True
        thread.join(10)
        listener.close()


@contextmanager
def page_process(settings: Path) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """`cellctl-hmi` with these settings, and its address."""
    with subprocess.Popen(
        [sys.executable, "-m", "cellctl.hmi", "serve", "--settings", str(settings)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
    ) as process:
        try:
            assert process.stdout is not None
            yield process, json.loads(process.stdout.readline())["url"]
        finally:
            process.terminate()
            process.wait(10)
