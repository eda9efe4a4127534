"""The touch detector: a cumulative sum (CUSUM) of how far the force exceeds a drift level.

A plain threshold low enough for a gentle touch alarms on noise and vibration more than once a
second; summing the excess over several samples does not, and costs about a millisecond of delay.
Simulated at 1 kHz with 2.5 N of noise and 2 N rms of vibration: 4771 false alarms an hour at a
plain 8 N, none by the sum, which alarms at 8, 12, 19 and 31 N in the mean on ramps of 100, 300,
1000 and 3000 N/s.
Planning needs to know at which force the detector alarms, and the guard runs the detector on every
sample. Both use this module, so that the plan and the guard cannot disagree. It works on plain
floats: the guard process must not import arrays.
"""

import math
from dataclasses import dataclass

TOUCH_IMPULSE_N_S = 0.12
"""Excess force integrated over time that counts as a touch: 120 N summed over samples at 1 kHz."""

LEAST_THRESHOLD_N = 60.0
"""Lower bound of the threshold. At a low sample rate only a handful of samples would make up the
sum, and a handful cannot tell a touch from noise."""


@dataclass(frozen=True, slots=True)
class Cusum:
    """Settings of the detector: it alarms when ``Σ max(0, f − drift)`` exceeds the threshold."""

    drift_n: float = 4.0
    """Force that adds nothing to the sum: above the noise and what a tare leaves."""
    threshold_n: float = 120.0
    """The sum runs over samples, so a threshold belongs to one sample rate, here 1 kHz."""

    def force_at_alarm(self, rate_n_s: float, sample_period_s: float) -> float:
        """Mean force (N) at the alarm when the force rises from zero at ``rate_n_s``.

        On a ramp of r N/s each sample exceeds the drift by r·T more than the one before. The sum
        after n samples is about r·T·n²/2, so it reaches the threshold h at
        F = drift + sqrt(2·h·r·T).
        """
        return self.drift_n + math.sqrt(2.0 * self.threshold_n * rate_n_s * sample_period_s)


class CusumDetector:
    """The running detector: takes one force at a time."""

    def __init__(self, settings: Cusum) -> None:
        self._drift_n, self._threshold_n = settings.drift_n, settings.threshold_n
        self._sum_n = 0.0

    def update(self, force_n: float) -> bool:
        """Add a sample; True when the sum exceeds the threshold. An alarm starts a new sum.

        The sum never falls below zero: otherwise the quiet time before a touch would pile up a
        negative sum, and the touch would have to work that off first.
        """
        self._sum_n = max(0.0, self._sum_n + force_n - self._drift_n)
        alarm = self._sum_n > self._threshold_n
        if alarm:
            self._sum_n = 0.0
        return alarm


def touch_threshold_n(rate_hz: float) -> float:
    """Threshold of the sum that means the same touch at any sample rate."""
    # In proportion to the rate, because the sum has one term for each sample: the same force then
    # takes the same time to alarm.
    return max(TOUCH_IMPULSE_N_S * rate_hz, LEAST_THRESHOLD_N)
