"""The largest true forces on the peg: at an instant, and as means over 3 and 20 ms."""

from dataclasses import dataclass, field

import numpy as np

from fakes.world.frames import Array

WINDOWS_MS = (1, 3, 20)
_PLACES = {
    window: [
        np.arange(tick - window + 1, tick + 1) % max(WINDOWS_MS) for tick in range(max(WINDOWS_MS))
    ]
    for window in WINDOWS_MS
}
"""Places of a window's samples in a ring of the longest window, by the place of the newest one."""


@dataclass(slots=True, eq=False)
class ForcePeaks:
    """Fed once a millisecond; a mean is that of the vectors, not of their lengths."""

    force_n: dict[int, float] = field(default_factory=lambda: dict.fromkeys(WINDOWS_MS, 0.0))
    moment_nm: dict[int, float] = field(default_factory=lambda: dict.fromkeys(WINDOWS_MS, 0.0))
    _last: Array = field(default_factory=lambda: np.zeros((max(WINDOWS_MS), 6)))
    _tick: int = 0
    _quiet: int = max(WINDOWS_MS)

    def take(self, wrench: Array) -> None:
        """The wrench on the peg in this millisecond, shape (6,)."""
        longest = len(self._last)
        self._quiet = 0 if wrench.any() else self._quiet + 1
        # Nothing in the longest window, so no mean can grow. Most of the time nothing touches, and
        # this is called a thousand times a second.
        if self._quiet > longest:
            return
        self._tick += 1
        self._last[self._tick % longest] = wrench
        for window in WINDOWS_MS:
            mean = self._last[_PLACES[window][self._tick % longest]].sum(axis=0) / window
            force, moment = mean[:3], mean[3:]
            self.force_n[window] = max(self.force_n[window], float(np.sqrt(force @ force)))
            self.moment_nm[window] = max(self.moment_nm[window], float(np.sqrt(moment @ moment)))
