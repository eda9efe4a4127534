"""The cell that a command means when nobody names one: the installed service's, else the last one
that was started in this folder, by hand or by a demonstration."""

import os
from pathlib import Path
from typing import Annotated

import typer

from cellctl.errors.records import StoreUnavailable

SERVICE_SOCKET = Path("/run/cellctl/cellctl.sock")
SERVICE_STORE = Path("/var/lib/cellctl")
SERVICE_CELL = Path("/etc/cellctl/cell.toml")
_STARTED_HERE = ("runs", "runs/*/store")
"""Where `cellctl run` with the shipped cell files and `cellctl demo` keep store and socket."""

SocketOption = Annotated[
    Path | None,
    typer.Option(
        "--socket",
        envvar="CELLCTL_SOCKET",
        help=f"The daemon's socket; default: {SERVICE_SOCKET}, else the newest below runs/.",
    ),
]


def nearest_store() -> Path:
    """The folder of the run store; raises ``StoreUnavailable`` where there is none."""
    file = _nearest(SERVICE_STORE, "store.sqlite")
    if file is None:
        places = ", ".join((str(SERVICE_STORE), *_STARTED_HERE))
        raise StoreUnavailable(f"none in {places}; --data-dir names another folder")
    return file.parent


def nearest_socket() -> Path:
    """The daemon's socket; that of the service where there is none at all."""
    return _nearest(SERVICE_SOCKET.parent, SERVICE_SOCKET.name) or SERVICE_SOCKET


def _nearest(service: Path, name: str) -> Path | None:
    """The service's file, also where this user may not read it; else the newest below here."""
    # `os.path`, because `Path.exists` raises where a folder above may not be entered.
    if os.path.exists(service / name):
        return service / name
    here = [path for pattern in _STARTED_HERE for path in Path().glob(f"{pattern}/{name}")]
    return max(here, key=lambda path: path.stat().st_mtime, default=None)
