"""The clock of a fake cell: the PC's own, without the moments in which the PC gave no time."""

import time
from collections.abc import Callable

LONGEST_STEP_S = 0.02
"""Twice what the devices' own work delays a turn of the loop on two busy processors.

A stall of the PC shorter than this is caught up like a late task; of a longer one the rest is lost.
"""


class WorldClock:
    """Seconds since switch-on. From one reading to the next at most ``LONGEST_STEP_S`` pass.

    Real devices do not stand still with the PC that they are wired to, fake ones do: a sensor that
    has to compute 100 ms of contact before it sends again looks silent, and then too fast. The
    world therefore loses such moments and runs slower than the PC while that has no time for it.
    How much was lost is a figure of every run, since the reactions of the cell controller are
    flattered by as much.
    """

    def __init__(self, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._monotonic_s = monotonic_s
        self._read_s = monotonic_s()
        self._now_s = 0.0
        self.lost_s = 0.0
        """Time of the PC that never passed in the world."""

    def __call__(self) -> float:
        """Time of the world."""
        read_s = self._monotonic_s()
        passed_s = read_s - self._read_s
        step_s = min(passed_s, LONGEST_STEP_S)
        self._read_s = read_s
        self._now_s += step_s
        self.lost_s += passed_s - step_s
        return self._now_s
