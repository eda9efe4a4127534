"""Since when a command that is read now may have been in its socket.

A daemon that stood still finds commands in its sockets and cannot see how long they have been
there. Whoever gave them was told that nobody answers, and may be in the cell.
"""

from cellctl.clock import Monotonic, now_s

HELD_S = 1.0
"""A turn of the event loop that took longer is one in which commands may have grown old. It is
short beside the age at which they are refused, and longer than what a busy PC makes of a turn."""
DRAIN_S = 0.25
"""So long after such a turn what is read may have come in it: a connection is accepted in one turn
and read in the next ones."""


class ArrivalClock:
    """Told of each turn of the event loop, which it belongs to."""

    def __init__(self, clock: Monotonic = now_s, held_s: float = HELD_S) -> None:
        self._now_s, self._held_s = clock, held_s
        self._turned_s = clock()
        self._held: tuple[float, float] | None = None
        """Begin and end of the last turn that took too long."""

    def turn(self) -> None:
        """The event loop has come round once more."""
        time_s = self._now_s()
        if time_s - self._turned_s > self._held_s:
            self._held = self._turned_s, time_s
        self._turned_s = time_s

    def given_s(self) -> float:
        """Monotonic time in seconds since when at the latest nobody has looked for the command that
        is read now; the present, unless the loop was held."""
        time_s = self._now_s()
        # The sockets are read before the timers of the same turn: nobody has told of it yet.
        if time_s - self._turned_s > self._held_s:
            return self._turned_s
        if self._held is not None and time_s - self._held[1] < DRAIN_S:
            return self._held[0]
        return time_s
