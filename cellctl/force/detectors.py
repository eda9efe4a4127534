"""Touch detectors on recorded forces: for analysis and for choosing the guard's settings.

The guard runs its own scalar versions sample by sample; these take whole records.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from cellctl.geometry.pose import Array

TOUCH_IMPULSE_N_S = 0.12
"""Excess that counts as a touch: 120 N over samples at 1 kHz, where it was chosen."""
LEAST_THRESHOLD_N = 60.0
"""A slow sensor has few samples to tell a touch from noise: the sum of a handful proves nothing."""


def touch_threshold_n(rate_hz: float) -> float:
    """Threshold of the sum over samples for the same touch at any sample rate."""
    return max(TOUCH_IMPULSE_N_S * rate_hz, LEAST_THRESHOLD_N)


@dataclass(frozen=True, slots=True)
class Cusum:
    """One-sided cumulative sum: alarm when ``Σ max(0, f − drift)`` exceeds the threshold."""

    drift_n: float = 4.0
    threshold_n: float = 120.0
    """Sum of the excess over samples, N."""

    def statistic(self, force_n: Array) -> Array:
        """The sum after each sample, not reset by an alarm; shape (n,)."""
        total = np.cumsum(force_n - self.drift_n)
        return np.asarray(total - np.minimum(np.minimum.accumulate(total), 0.0))

    def first_alarm(self, force_n: Array) -> int | None:
        """Index of the first sample above the threshold, or None."""
        return _first(self.statistic(force_n) > self.threshold_n)

    def force_at_alarm(self, rate_n_s: float, sample_period_s: float) -> float:
        """Mean force (N) at the alarm on a ramp that starts at zero.

        A ramp of r N/s passes the drift and adds r·T a sample to the excess: the sum reaches the
        threshold h at F = drift + sqrt(2·h·r·T).
        """
        return self.drift_n + float(np.sqrt(2.0 * self.threshold_n * rate_n_s * sample_period_s))


def low_pass(signal: Array, time_constant_s: float, sample_period_s: float) -> Array:
    """First-order low-pass along axis 0, starting at the first sample."""
    gain = -np.expm1(-sample_period_s / time_constant_s)
    start = (1.0 - gain) * np.asarray(signal[:1], dtype=float)
    filtered, _ = lfilter([gain], [1.0, gain - 1.0], signal, axis=0, zi=start)
    return np.asarray(filtered)


def above(force_n: Array, limit_n: float) -> int | None:
    """Index of the first sample above the limit."""
    return _first(force_n > limit_n)


def _first(flags: NDArray[np.bool_]) -> int | None:
    index = int(np.argmax(flags))
    return index if bool(flags[index]) else None
