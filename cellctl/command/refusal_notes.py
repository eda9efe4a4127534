"""Which refusals the audit log is told of: each one, as long as they do not come by the hundred."""

from collections import deque

from cellctl.clock import Monotonic, now_s
from cellctl.packml.unit_command import Source

NOTED_A_MINUTE = 60
"""Refusals of each source that are noted. Whoever may not even stop the cell, or a PLC that asks
again and again, could else fill the disk."""
_MINUTE_S = 60.0


class RefusalNotes:
    """Counts the refusals of each source. Belongs to one event loop."""

    def __init__(self, *, clock: Monotonic = now_s) -> None:
        self._now_s = clock
        self._noted_s = {source: deque[float](maxlen=NOTED_A_MINUTE) for source in Source}
        self._left_out = dict.fromkeys(Source, 0)

    def take(self, source: Source) -> int | None:
        """How many refusals before this one were left out since the last note; None where this one
        has to be left out itself."""
        time_s, noted_s = self._now_s(), self._noted_s[source]
        if len(noted_s) == NOTED_A_MINUTE and time_s - noted_s[0] < _MINUTE_S:
            self._left_out[source] += 1
            return None
        noted_s.append(time_s)
        left_out, self._left_out[source] = self._left_out[source], 0
        return left_out
