"""Whether the daemon itself is well: for pages and for whoever watches many cells."""

import os
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cellctl.clock import now_s

LOOKED_BACK_S = 15.0
"""How often Prometheus usually asks: no late turn falls between two of its questions."""
_STATM = Path("/proc/self/statm")
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


class DaemonVitals:
    """Belongs to the event loop."""

    def __init__(
        self, line_beat_age_s: Callable[[], float | None], clock: Callable[[], float] = now_s
    ) -> None:
        """``line_beat_age_s``: since the counter of the line PLC has changed, None before."""
        self._line_beat_age_s, self._clock = line_beat_age_s, clock
        # (time, lateness) of the turns that were later than every turn after them. So the lateness
        # falls from the first to the last, and the first is the greatest of the window: that costs
        # a few entries in place of all turns of fifteen seconds.
        self._late: deque[tuple[float, float]] = deque()

    def turn(self, late_s: float) -> None:
        """Note that the event loop took a turn ``late_s`` after it was due."""
        while self._late and self._late[-1][1] <= late_s:
            self._late.pop()
        self._late.append((self._clock(), late_s))
        self._forget()

    def snapshot(self) -> dict[str, Any]:
        """The vitals as plain data, from memory but for one line of the kernel's."""
        self._forget()
        return {
            "loop_late_s": self._late[0][1] if self._late else None,
            "line_beat_age_s": self._line_beat_age_s(),
            "resident_bytes": int(_STATM.read_text("ascii").split()[1]) * _PAGE_BYTES,
        }

    def _forget(self) -> None:
        while self._late and self._clock() - self._late[0][0] > LOOKED_BACK_S:
            self._late.popleft()
