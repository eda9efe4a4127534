"""What the doctor sees of a PC."""

import ctypes
import grp
import pwd
import shutil
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

_TIMEX_BYTES = 512
"""More than ``struct timex`` of any Linux takes (208 on 64 bits)."""
_TIME_ERROR = 5
_UNREACHED_PORT = 9
"""Discard. Any port would do, because nothing is sent: connecting a datagram socket only makes the
kernel look up the route."""


def _clock_is_set() -> bool:
    """Whether the kernel holds the clock for synchronised (man 2 adjtimex: not ``TIME_ERROR``)."""
    nothing_to_set = ctypes.create_string_buffer(_TIMEX_BYTES)
    return ctypes.CDLL(None, use_errno=True).adjtimex(nothing_to_set) not in {-1, _TIME_ERROR}


def _own_address_towards(peer: str) -> str | None:
    with socket.socket(_family(peer), socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((peer, _UNREACHED_PORT))
        except OSError:
            return None
        return str(probe.getsockname()[0])


def _is_own_address(address: str) -> bool:
    with socket.socket(_family(address), socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
        return True


def _family(address: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in address else socket.AF_INET


def _user(name: str) -> pwd.struct_passwd | None:
    try:
        return pwd.getpwnam(name)
    except KeyError:
        return None


def _group(name: str) -> grp.struct_group | None:
    try:
        return grp.getgrnam(name)
    except KeyError:
        return None


@dataclass(frozen=True, slots=True)
class Pc:
    """Files below ``root``, and questions that only the running system answers."""

    root: Path = Path("/")
    user: Callable[[str], pwd.struct_passwd | None] = _user
    group: Callable[[str], grp.struct_group | None] = _group
    clock_is_set: Callable[[], bool] = _clock_is_set
    time_s: Callable[[], float] = time.time
    """Seconds since 1970."""
    own_address_towards: Callable[[str], str | None] = _own_address_towards
    """The address with which this PC would speak to a peer; None without a way."""
    is_own_address: Callable[[str], bool] = _is_own_address
    free_bytes: Callable[[Path], int] = field(default=lambda path: shutil.disk_usage(path).free)

    def path(self, absolute: str | Path) -> Path:
        """Where a file of the PC lies."""
        return self.root / str(absolute).lstrip("/")

    def read(self, absolute: str | Path) -> str | None:
        """Text of a file without blanks around it; None when it cannot be read."""
        try:
            return self.path(absolute).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:
            return None

    def find(self, pattern: str) -> Iterator[Path]:
        """Files that match, such as ``/sys/class/net/*/mtu``, as the PC names them, in order."""
        for place in sorted(self.root.glob(pattern.lstrip("/"))):
            yield Path("/") / place.relative_to(self.root)
