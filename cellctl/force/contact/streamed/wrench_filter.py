"""First-order low-pass of the wrench, with the noise that it leaves.

The same filter as ``LowPass`` of the guard, which may not load arrays (``guard.watch.detectors``).
"""

import numpy as np

from cellctl.geometry.pose import Array


class WrenchFilter:
    """Takes samples as they come, at whatever times; shape (6,)."""

    def __init__(self, time_constant_s: float) -> None:
        self._constant_s = time_constant_s
        self._time_s = -np.inf
        self.value: Array = np.zeros(6)

    @property
    def time_s(self) -> float:
        """Time of the newest sample; minus infinity before the first."""
        return self._time_s

    def take(self, times_s: Array, wrenches: Array) -> None:
        """Samples in the order of their times, shapes (n,) and (n, 6)."""
        for time_s, wrench in zip(times_s, wrenches, strict=True):
            if self._time_s == -np.inf:
                self.value = np.array(wrench)
            else:
                # Exact for a value that is held between samples, whatever time has passed.
                share = 1.0 - np.exp(-(time_s - self._time_s) / self._constant_s)
                self.value = self.value + share * (wrench - self.value)
            self._time_s = float(time_s)


def left_of_noise(time_constant_s: float, sample_s: float) -> float:
    """Ratio of the standard deviation after the filter to that before, for white noise.

    Of y' = y + a (x − y) the variance settles at a / (2 − a) of that of x.
    """
    share = 1.0 - np.exp(-sample_s / time_constant_s)
    return float(np.sqrt(share / (2.0 - share)))
