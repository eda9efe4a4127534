"""The box over TCP: it listens, the PC connects."""

import errno
import select
import socket
from typing import Any, NamedTuple

from drivers.ftsensor.sri import faults
from drivers.ftsensor.sri.connection import Connection

_CHUNK_BYTES = 4096
_UNANSWERED_MS = 2000
"""What was sent and is not acknowledged by then ends the link; see ``connect``."""


class _Found(NamedTuple):
    """What a name stands for."""

    family: int
    address: Any


def _look_up(host: str, port: int) -> _Found:
    family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    return _Found(family, address)


class TcpConnection(Connection):
    """A non-blocking socket without Nagle's delay."""

    def __init__(self, host: str, port: int) -> None:
        self.peer = f"{host}:{port}"
        self._host, self._port = host, port
        self._found: _Found | None = None
        self._answered: _Found | None = None
        """Where the box has answered before."""
        self._socket: socket.socket | None = None
        self._established = False

    def connect(self) -> None:
        """Begin; a name that does not resolve is ``ConnectTimeout``.

        A name is looked up until the box has answered there, and then no more: a dead name server
        takes seconds, in which the guard would neither beat nor repeat its stop.
        """
        self.close()
        try:
            self._found = self._answered or _look_up(self._host, self._port)
            self._socket = socket.socket(self._found.family, socket.SOCK_STREAM)
            self._socket.settimeout(0.0)
            # Otherwise a command waits for the acknowledgement of the one before, some 40 ms.
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            # A pulled cable sends no farewell. Without this limit the kernel repeats what was sent
            # for a quarter of an hour before it reports the link as lost.
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _UNANSWERED_MS)
            code = self._socket.connect_ex(self._found.address)
        # A name that cannot be one, such as "box..local", is refused by its encoding.
        except (OSError, UnicodeError) as error:
            self.close()
            raise faults.cannot_connect(self.peer, error) from error
        if code not in (0, errno.EINPROGRESS):
            self.close()
            raise faults.cannot_connect(self.peer, errno.errorcode.get(code, code))

    def established(self) -> bool:
        """True once the handshake of TCP is through."""
        if self._established:
            return True
        if self._socket is None:
            raise faults.lost(self.peer, "not connected")
        if not select.select([], [self._socket], [], 0.0)[1]:
            return False
        # A socket becomes writable when the connection stands and also when it has failed.
        code = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if code:
            self.close()
            raise faults.cannot_connect(self.peer, errno.errorcode.get(code, code))
        self._established = True
        self._answered = self._found
        return True

    def close(self) -> None:
        """Drop the link."""
        if self._socket is not None:
            self._socket.close()
        self._socket, self._established = None, False

    def fileno(self) -> int:
        """Descriptor of the socket; -1 until it is established."""
        return self._socket.fileno() if self._socket is not None and self._established else -1

    def wait(self, timeout_s: float) -> None:
        """Wait for bytes, or while connecting for the end of the attempt."""
        sockets = [] if self._socket is None else [self._socket]
        connecting = [] if self._established else sockets
        select.select(sockets, connecting, [], timeout_s)

    def send(self, data: bytes) -> None:
        """Hand the bytes to the kernel."""
        if self._socket is None:
            raise faults.lost(self.peer, "not connected")
        try:
            self._socket.sendall(data)
        except OSError as error:
            self.close()
            raise faults.lost(self.peer, error) from error

    def receive(self) -> bytes:
        """What the kernel holds."""
        if self._socket is None:
            raise faults.lost(self.peer, "not connected")
        try:
            data = self._socket.recv(_CHUNK_BYTES)
        except BlockingIOError:
            return b""
        except OSError as error:
            self.close()
            raise faults.lost(self.peer, error) from error
        if not data:
            self.close()
            raise faults.lost(self.peer, "closed by the box")
        return data
