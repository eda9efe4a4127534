"""The socket in the file system: who may connect, and how the file of a dead daemon is replaced."""

import os
import shutil
import socket
import stat
from pathlib import Path

from cellctl.config.cell import MOST_SOCKET_BYTES
from cellctl.errors.local import CannotServeLocally, LocalApiInUse

MODE = 0o660
"""Reading and writing for the daemon's user and the group; nobody else may connect."""
_NAME = "cellctl.sock"


def default_path(data_dir: Path) -> Path:
    """Path of the socket: in the runtime directory that systemd gives the service, else in
    ``data_dir``."""
    runtime = os.environ.get("RUNTIME_DIRECTORY", "").split(":")[0]
    return (Path(runtime) if runtime else data_dir) / _NAME


class SocketFile:
    """A listening socket that removes its file at the end."""

    def __init__(self, path: Path, group: str) -> None:
        """``group``: name of the group that may connect; empty for the daemon's own."""
        self.path = path
        self._group = group
        self._inode = 0

    def open(self) -> socket.socket:
        """Listen; replaces the file that a dead daemon has left.

        Raises ``LocalApiInUse`` while somebody listens there, else ``CannotServeLocally``.
        """
        # The kernel's own error names no reason.
        if len(os.fsencode(self.path)) > MOST_SOCKET_BYTES:
            raise CannotServeLocally(f"{self.path} is longer than {MOST_SOCKET_BYTES} bytes")
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._make_room()
            os.fchmod(listener.fileno(), 0o600)  # of the file to come: nobody connects too early
            listener.bind(str(self.path))
            # Remembered, so that at the end only this daemon's own file is removed: a successor may
            # have replaced it by then.
            self._inode = self.path.stat().st_ino
            if self._group:
                shutil.chown(self.path, group=self._group)
            self.path.chmod(MODE)
            listener.setblocking(False)  # noqa: FBT003 - the library's own signature
        except (OSError, LookupError) as error:
            listener.close()
            self.remove()
            raise CannotServeLocally(f"{self.path}: {error}") from error
        except LocalApiInUse:
            listener.close()
            raise
        return listener

    def remove(self) -> None:
        """Remove the file, unless it belongs to another daemon by now. Idempotent."""
        try:
            if self._inode and self.path.stat().st_ino == self._inode:
                self.path.unlink()
        except FileNotFoundError:
            pass
        self._inode = 0

    def _make_room(self) -> None:
        try:
            found = self.path.lstat()
        except FileNotFoundError:
            return
        # With a wrong path in the cell file, the file of somebody else must not be deleted.
        if not stat.S_ISSOCK(found.st_mode):
            raise FileExistsError("is no socket")
        # A dead daemon leaves its file behind. Only a connection tells it from one that is alive.
        if _somebody_listens(self.path):
            raise LocalApiInUse(str(self.path))
        self.path.unlink()


def _somebody_listens(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM | socket.SOCK_NONBLOCK) as probe:
        try:
            probe.connect(str(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return False
        except BlockingIOError:
            return True  # its queue is full
    return True
