"""The local API of one daemon, put together."""

from pathlib import Path

from cellctl.cell.archive import Archive
from cellctl.cell.devices import Cell
from cellctl.daemon.line import Line
from cellctl.daemon.local.reporter import Reporter
from cellctl.daemon.local.server import LocalServer
from cellctl.daemon.local.socket_file import SocketFile, default_path
from cellctl.daemon.local.terminal import Terminal
from cellctl.daemon.unit import Unit


def local_server(
    cell: Cell, unit: Unit, line: Line, archive: Archive, data_dir: Path
) -> LocalServer:
    """Not yet listening; ``data_dir`` has the socket unless cell file or systemd say otherwise."""
    settings = cell.config.local_api
    path = Path(settings.socket) if settings.socket else default_path(data_dir)
    reporter = Reporter(cell, unit, line, archive)
    terminal = Terminal(cell.config, unit.machine, line, reporter)
    return LocalServer(SocketFile(path, settings.group), terminal.handle)
