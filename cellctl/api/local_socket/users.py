"""The user at the other end of a connection: number from the kernel, name for the records."""

import asyncio
import pwd
import socket
import struct
from pathlib import Path

_CREDENTIALS = struct.Struct("3i")
"""``struct ucred`` of ``unix(7)``: process, user and group."""
_LOOKUP_S = 1.0
"""Longest wait for a directory service. Its answer is only a name for the records, and a command
must not wait longer for it."""
_LOCAL_USERS = Path("/etc/passwd")


def peer_uid(sock: socket.socket) -> int:
    """The user behind a connected Unix-domain socket (SO_PEERCRED)."""
    raw = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    _, uid, _ = _CREDENTIALS.unpack(raw)
    return int(uid)


class Users:
    """Names of users by number.

    The users of this PC are known at once; those of a directory service are looked up on demand.
    """

    def __init__(self) -> None:
        self._names: dict[int, str] = {}
        # Read once and here: ``pwd`` also asks directory services, which may block for seconds.
        for line in _LOCAL_USERS.read_text(encoding="utf-8", errors="replace").splitlines():
            name, *rest = line.split(":")
            if len(rest) > 1 and rest[1].isdigit():
                self._names.setdefault(int(rest[1]), name)

    def name(self, uid: int) -> str:
        """The user's name as far as it is known by now; else the number."""
        return self._names.get(uid, str(uid))

    async def look_up(self, uid: int) -> None:
        """Look up a name that is not known; gives up after a second and leaves it unknown."""
        if uid in self._names:
            return
        try:
            async with asyncio.timeout(_LOOKUP_S):
                # In a thread, because the call cannot be cancelled: after the time-out it ends by
                # itself, unheard.
                entry = await asyncio.to_thread(pwd.getpwuid, uid)
        except (TimeoutError, KeyError):
            return
        self._names[uid] = entry.pw_name
