"""The largest true forces on the peg: at an instant, and as means over 3 and 20 ms."""

from dataclasses import dataclass, field

import numpy as np

from fakes.world.frames import Array

WINDOWS_MS = (1, 3, 20)
_BEFORE = max(WINDOWS_MS) - 1


@dataclass(slots=True, eq=False)
class ForcePeaks:
    """Fed with every millisecond; a mean is that of the vectors, not of their lengths."""

    force_n: dict[int, float] = field(default_factory=lambda: dict.fromkeys(WINDOWS_MS, 0.0))
    moment_n_m: dict[int, float] = field(default_factory=lambda: dict.fromkeys(WINDOWS_MS, 0.0))
    _last: Array = field(default_factory=lambda: np.zeros((_BEFORE, 6)))

    def take(self, wrenches: Array) -> None:
        """The wrenches on the peg in the next milliseconds, shape (n, 6)."""
        rows = np.concatenate([self._last, wrenches])
        self._last = rows[-_BEFORE:]
        # Most of the time nothing touches, and this is called up to a thousand times a second.
        if not rows.any():
            return
        summed = np.zeros((len(rows) + 1, 6))
        rows.cumsum(axis=0, out=summed[1:])
        for window in WINDOWS_MS:
            means = (summed[_BEFORE + 1 :] - summed[_BEFORE + 1 - window : -window]) / window
            squares = means * means
            force_n, moment_n_m = squares[:, :3].sum(axis=1), squares[:, 3:].sum(axis=1)
            self.force_n[window] = max(self.force_n[window], float(force_n.max()) ** 0.5)
            self.moment_n_m[window] = max(self.moment_n_m[window], float(moment_n_m.max()) ** 0.5)
