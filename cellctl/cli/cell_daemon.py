"""The daemon that works with a cell file, if one runs."""

from pathlib import Path

from cellctl.api.local_socket.report import StatusReport
from cellctl.api.local_socket.socket_file import default_path
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.config import CellConfig
from cellctl.errors.local import CellInUse, DaemonNotReached


def client_of(cell: CellConfig, socket: Path | None) -> DaemonClient:
    """A client of the daemon of this cell: at ``socket``, else where the cell file has it, else the
    nearest one, which may be that of another cell."""
    stated = Path(cell.local_api.socket) if cell.local_api.socket else None
    beside = default_path(Path(cell.data_dir))
    return DaemonClient(socket or stated or (beside if beside.exists() else None))


def require_no_daemon(cell: CellConfig, socket: Path | None) -> None:
    """Raise ``CellInUse`` while a daemon of this cell runs, before anything of it is asked."""
    report = running_daemon(cell, socket)
    if report is not None:
        raise CellInUse(f"the daemon of {cell.name} runs and is {report.state}")


def running_daemon(cell: CellConfig, socket: Path | None) -> StatusReport | None:
    """What the daemon of this cell says of itself; None where none can be reached.

    Raises ``MessageMalformed`` for one of another version, whose cell cannot be told.
    """
    try:
        report = client_of(cell, socket).status()
    except DaemonNotReached:
        return None
    # A service of another cell may run on this PC.
    return report if report.cell == cell.name else None
