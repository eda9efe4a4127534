"""Log lines on their way to the disk, beside those who log."""

import queue
import threading
from typing import Protocol

MOST_LINES = 10_000
"""Some megabytes. A disk that is behind by more has hung, and what it misses is counted."""
_END_S = 2.0


class Stream(Protocol):
    """Where lines go in the end; counts what is lost in ``lost``."""

    lost: int

    def write(self, text: str) -> int:
        """May take long, never raises."""

    def flush(self) -> None:
        """Likewise."""

    def isatty(self) -> bool:
        """True for a terminal."""


class LogThread:
    """A stream that never makes its writer wait.

    A file system that is busy with images holds a write for seconds. On the event loop that would
    be seconds without a sign of life to the robots.
    """

    def __init__(self, stream: Stream, most_lines: int = MOST_LINES) -> None:
        self._stream = stream
        self._lines: queue.Queue[str | None] = queue.Queue(most_lines)
        self._lost = self._told = 0
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def write(self, text: str) -> int:
        """Hand over a line; one for which there is no room is counted."""
        try:
            self._lines.put_nowait(text)
        except queue.Full:
            self._lost += 1
        return len(text)

    def flush(self) -> None:
        """Nothing: the thread flushes."""

    def isatty(self) -> bool:
        """As the stream below."""
        return self._stream.isatty()

    def close(self, timeout_s: float = _END_S) -> None:
        """Wait until all lines are written, but not for a disk that hangs."""
        try:
            self._lines.put(None, timeout=timeout_s)
        except queue.Full:
            return  # what hangs is no reason to stay
        self._thread.join(timeout_s)

    def _run(self) -> None:
        while (line := self._lines.get()) is not None:
            # Loggers only count up and this thread only remembers, so that no count is overwritten.
            lost = self._lost
            self._stream.lost, self._told = self._stream.lost + lost - self._told, lost
            self._stream.write(line)
            self._stream.flush()
