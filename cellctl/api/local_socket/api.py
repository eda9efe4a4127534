"""Wires up the local API of one daemon."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cellctl.api.local_socket.live_feed import LiveFeed
from cellctl.api.local_socket.live_view import LiveView
from cellctl.api.local_socket.reporter import Reporter
from cellctl.api.local_socket.server import LocalServer
from cellctl.api.local_socket.socket_file import SocketFile, default_path
from cellctl.api.local_socket.terminal import Terminal
from cellctl.cell.devices import Cell
from cellctl.clock import Monotonic
from cellctl.command.arbiter import CommandArbiter
from cellctl.records.async_store import AsyncRunStore
from cellctl.runtime.unit import UnitController


@dataclass(frozen=True, slots=True)
class LocalApiParts:
    """What the daemon keeps of the local API."""

    server: LocalServer
    """The server of the socket; it does not listen yet."""
    feed: LiveFeed


def local_api(
    cell: Cell,
    unit: UnitController,
    arbiter: CommandArbiter,
    store: AsyncRunStore,
    data_dir: Path,
    *,
    registers: Callable[[], list[dict[str, Any]]],
    daemon: Callable[[], dict[str, Any]],
    given_s: Monotonic,
) -> LocalApiParts:
    """``data_dir`` has the socket unless cell file or systemd say otherwise.

    ``registers`` gives what the line PLC and the cell show each other, ``daemon`` whether the
    daemon itself is well, ``given_s`` since when a command that is read now may have waited.
    """
    settings = cell.config.local_api
    path = Path(settings.socket) if settings.socket else default_path(data_dir)
    view = LiveView(cell, unit, arbiter, daemon)
    reporter = Reporter(cell, unit, arbiter, store, view)

    async def describe() -> dict[str, Any]:
        return {**await reporter.description(), "registers": registers()}

    feed = LiveFeed(view, describe)
    # The terminal is given the way to submit a command and to note a refusal, and nothing else of
    # the arbiter, so that it cannot pass by the validation.
    terminal = Terminal(
        cell.config,
        unit.machine,
        arbiter.submit,
        reporter,
        view,
        note_refusal=arbiter.note_refusal,
        given_s=given_s,
    )
    server = LocalServer(SocketFile(path, settings.group), terminal.handle, feed.follow)
    return LocalApiParts(server, feed)
