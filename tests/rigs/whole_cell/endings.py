"""How a program should end, or wait, that lacks something."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from tests.rigs.whole_cell.own_cell import Program


def refuses(program: Program, *words: str, code: int = 1, timeout_s: float = 40) -> str:
    """It ends with that code and these words; what it said on standard error."""
    assert program.end(timeout_s) == code, program.stdout + program.stderr
    program.nobody_left()
    said = program.stderr
    assert "Traceback" not in said
    for word in words:
        assert word in said
    assert "remedy: " in said
    return said


def waits(daemon: Program, *words: str, timeout_s: float = 40) -> str:
    """It stays, Aborted, and says these words; the fault."""
    said: dict[str, Any] = daemon.until(
        "what is missing",
        lambda: next((m for m in daemon.messages if m.get("ready") is False), None),
        timeout_s,
    )
    for word in words:
        assert word in said["error"]
    assert "Traceback" not in daemon.stderr
    return str(said["error"])


@contextmanager
def taken(port: int, host: str = "127.0.0.1") -> Iterator[None]:
    """Another program listens there."""
    with socket.create_server((host, port)):
        yield
