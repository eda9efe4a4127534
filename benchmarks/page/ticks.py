"""How late the ticks of a daemon come, as a follower of its own sees them."""

import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from cellctl.api.local_socket.messages import FollowRequest, to_line

PERIOD_S = 0.1
"""The daemon pushes a snapshot at least so often."""
CONNECT_S = 30.0


@dataclass
class Ticks:
    """What one follower has heard; a page beside it is the other one that a daemon allows."""

    late_s: list[float] = field(default_factory=list)
    """By how much the time from one snapshot to the next was longer than their period."""
    under_way_s: list[float] = field(default_factory=list)
    """From the tick in the daemon to its line here."""
    ended: str = ""
    """Why the daemon's lines came to an end, if they did."""


@contextmanager
def followed(path: Path) -> Iterator[Ticks]:
    """Follow the daemon at this socket meanwhile; raises ``OSError`` where there is none."""
    ticks, over = Ticks(), threading.Event()
    with socket.socket(socket.AF_UNIX) as link:
        link.settimeout(CONNECT_S)
        link.connect(str(path))
        link.sendall(to_line(FollowRequest()))
        reader = threading.Thread(target=_read, args=(link, ticks, over), name="follow the daemon")
        reader.start()
        try:
            yield ticks
        finally:
            over.set()
            link.shutdown(socket.SHUT_RDWR)
            reader.join()


def _read(link: socket.socket, ticks: Ticks, over: threading.Event) -> None:
    before_s: float | None = None
    try:
        with link.makefile("rb") as lines:
            for line in lines:
                here_s, said = time.monotonic(), json.loads(line)
                if said["kind"] != "snapshot":
                    continue
                if before_s is not None:
                    ticks.late_s.append(max(0.0, said["mono_s"] - before_s - PERIOD_S))
                before_s = said["mono_s"]
                ticks.under_way_s.append(here_s - said["mono_s"])
    except (OSError, ValueError) as error:
        ticks.ended = repr(error)
    if not over.is_set() and not ticks.ended:
        ticks.ended = "the daemon has hung up"
