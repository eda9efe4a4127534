"""The cell that a command means when nobody names one: the installed service's, else the last one
that was started in this folder, by hand or by a demonstration."""

import os
import socket
from pathlib import Path
from typing import Annotated

import typer

from cellctl.errors.records.store import StoreUnavailable

SERVICE_SOCKET = Path("/run/cellctl/cellctl.sock")
SERVICE_STORE = Path("/var/lib/cellctl")
SERVICE_CELL = Path("/etc/cellctl/cell.toml")
_STARTED_HERE = ("runs", "runs/*", "runs/*/store")
"""Where `cellctl run` with the shipped cell files and `cellctl demo` keep store and socket."""

_PROBE_S = 1.0
"""A daemon accepts at once; one whose queue of connections is full is there, and slow."""

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
        raise StoreUnavailable(f"none in {_places(SERVICE_STORE)}; --data-dir names another folder")
    return file.parent


def socket_places() -> str:
    """Where ``nearest_socket`` looks, in words."""
    return f"{_places(SERVICE_SOCKET.parent)}; a daemon has its socket in its data_dir"


def _places(service: Path) -> str:
    return f"{service} and, below {Path.cwd()}, {', '.join(_STARTED_HERE)}"


def nearest_socket() -> Path:
    """The daemon's socket, one that is answered before one that a killed daemon left behind; that
    of the service where there is none at all."""
    found = _found(SERVICE_SOCKET.parent, SERVICE_SOCKET.name)
    answered = (path for path in found if _is_answered(path))
    return next(answered, found[0] if found else SERVICE_SOCKET)


def _nearest(service: Path, name: str) -> Path | None:
    found = _found(service, name)
    return found[0] if found else None


def _found(service: Path, name: str) -> list[Path]:
    """The service's file, also where this user may not read it; then those below here, the newest
    first."""
    here = [path for pattern in _STARTED_HERE for path in Path().glob(f"{pattern}/{name}")]
    newest_first = sorted(here, key=lambda path: path.stat().st_mtime, reverse=True)
    # `os.path`, because `Path.exists` raises where a folder above may not be entered.
    return [service / name] * os.path.exists(service / name) + newest_first


def _is_answered(path: Path) -> bool:
    """Whether a program listens at a socket, or at one that this user may not open."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(_PROBE_S)
        try:
            probe.connect(str(path))
        except PermissionError:
            return True  # it is the service's, and asking it says what is missing
        except OSError:
            return False
    return True
