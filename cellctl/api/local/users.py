"""Who is at the other end of a connection, as the kernel says, by name for the records."""

import asyncio
import pwd
import socket
import struct
from pathlib import Path

_CREDENTIALS = struct.Struct("3i")
_LOOKUP_S = 1.0
_LOCAL_USERS = Path("/etc/passwd")


def peer_uid(sock: socket.socket) -> int:
    """The user behind a connected Unix-domain socket (SO_PEERCRED)."""
    raw = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    _, uid, _ = _CREDENTIALS.unpack(raw)
    return int(uid)


class Users:
    """Names by number. This PC's own users are known at once; a directory service may be slow."""

    def __init__(self) -> None:
        self._names: dict[int, str] = {}
        for line in _LOCAL_USERS.read_text(encoding="utf-8", errors="replace").splitlines():
            name, *rest = line.split(":")
            if len(rest) > 1 and rest[1].isdigit():
                self._names.setdefault(int(rest[1]), name)

    def actor(self, uid: int) -> str:
        """For records; with the number where the name is not known."""
        return f"terminal:{self._names.get(uid, uid)}"

    async def look_up(self, uid: int) -> None:
        """Ask for a name that is not known; gives up after a second, the number has to do then."""
        if uid in self._names:
            return
        try:
            async with asyncio.timeout(_LOOKUP_S):
                entry = await asyncio.to_thread(pwd.getpwuid, uid)
        except (TimeoutError, KeyError):
            return
        self._names[uid] = entry.pw_name
