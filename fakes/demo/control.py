"""Client of the fake cell's control port: the operator's hands and the measuring room."""

import json
import socket
from typing import Any


class Refused(RuntimeError):
    """The fake cell does not do what it was asked for, or has gone."""


class Control:
    """Blocking request and reply, one JSON line each."""

    def __init__(self, port: int, timeout_s: float = 30.0) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=timeout_s)
        self._file = self._socket.makefile("rw", encoding="utf-8", newline="\n")
        self._id = 0

    def request(self, cmd: str, **arguments: Any) -> dict[str, Any]:
        """Send a command; raises ``Refused`` with the fake cell's message when it refuses."""
        self._id += 1
        self._file.write(json.dumps({"id": self._id, "cmd": cmd, **arguments}) + "\n")
        self._file.flush()
        line = self._file.readline()
        if not line:
            raise Refused("the fake cell closed its control port")
        reply: dict[str, Any] = json.loads(line)
        if reply.get("status") != "ok":
            raise Refused(f"fake cell refused {cmd}: {reply.get('message')}")
        return reply

    def close(self) -> None:
        """Hang up."""
        self._file.close()
        self._socket.close()
