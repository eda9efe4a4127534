"""Log lines with fields of systemd's journal: ``journalctl CELL_RUN=17 CELL_STEP=mate``.

The protocol is systemd's JOURNAL_NATIVE_PROTOCOL: one datagram an entry, ``NAME=value`` a line.
"""

import json
import os
import socket
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TextIO

JOURNAL = Path("/run/systemd/journal/socket")
_PRIORITIES = {"debug": 7, "info": 6, "warning": 4, "error": 3, "critical": 2}
"""Priorities of syslog by our levels; journalctl colours and selects by them."""
_FIELDS = {"run": "CELL_RUN", "step": "CELL_STEP", "module": "CELL_MODULE", "number": "CELL_FAULT"}
"""Field of the journal by name in the line; ``number`` is that of a fault."""


class JournalStream:
    """A stream for lines of JSON. What the journal does not take goes to the stream below.

    Waits for a journal that is behind, as a file would: meant for the thread of the log.
    """

    def __init__(self, below: TextIO, journal: Path) -> None:
        self._below = below
        self._journal = str(journal)
        self._channel = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)

    def write(self, text: str) -> int:
        """A whole line; raises ``OSError`` when the stream below does not take it either."""
        try:
            self._channel.sendto(_entry(text.rstrip("\n")), self._journal)
        except OSError:
            # A long traceback is too large for a datagram, and a journal that starts anew is away
            # for a moment. systemd reads the stream below, too, without the fields.
            return self._below.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream below; an entry has gone when it is written."""
        self._below.flush()

    def close(self) -> None:
        """The connection to the journal; the stream below stays open."""
        self._channel.close()

    def isatty(self) -> bool:
        """A journal is no terminal."""
        return False


def journal_or(stream: TextIO, journal: Path = JOURNAL) -> TextIO | JournalStream:
    """The journal where systemd has connected the stream to it, else the stream itself."""
    try:
        found = os.fstat(stream.fileno())
    except (OSError, ValueError):
        return stream  # no file: somebody reads it in this process
    # systemd says which stream it reads: one that was redirected since is not for the journal.
    if os.environ.get("JOURNAL_STREAM") != f"{found.st_dev}:{found.st_ino}":
        return stream
    return JournalStream(stream, journal)


def _entry(line: str) -> bytes:
    return b"".join(_field(name, value) for name, value in _fields(line))


def _fields(line: str) -> Iterator[tuple[str, str]]:
    # Whole, so that the journal shows and exports what the log file would have.
    yield "MESSAGE", line
    yield "SYSLOG_IDENTIFIER", "cellctl"
    values = _said_in(line)
    yield "PRIORITY", str(_PRIORITIES.get(values.get("level", "info"), 6))
    for name, field in _FIELDS.items():
        if name in values:
            yield field, str(values[name])


def _said_in(line: str) -> Mapping[str, Any]:
    """What a line of JSON says by name; nothing for a traceback, or for what a library prints."""
    try:
        found = json.loads(line)
    except ValueError:
        return {}
    # A line with nothing but a number or a list is JSON, too.
    return found if isinstance(found, dict) else {}


def _field(name: str, value: str) -> bytes:
    data = value.encode()
    if b"\n" not in data:
        return b"%s=%s\n" % (name.encode(), data)
    return b"%s\n%s%s\n" % (name.encode(), len(data).to_bytes(8, "little"), data)
