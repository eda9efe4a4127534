"""Streaming detectors: one sample at a time, plain floats, no memory beyond a few numbers.

Every comparison is written so that NaN counts as beyond. The studies behind the figures, and the
same detectors on whole records, are in ``cellctl.force.detectors``.
"""

import math
from collections import deque

from cellctl.guard.limits import CusumTouch, Six


def beyond(wrench: Six, limits: Six) -> int | None:
    """The first component whose magnitude is beyond its limit; None when all are within."""
    a, b, c, d, e, f = wrench
    p, q, r, s, t, u = limits
    if (
        -p <= a <= p
        and -q <= b <= q
        and -r <= c <= r
        and -s <= d <= s
        and -t <= e <= t
        and -u <= f <= u
    ):
        return None
    outside = (not -limit <= value <= limit for value, limit in zip(wrench, limits, strict=True))
    return next(index for index, is_outside in enumerate(outside) if is_outside)


class LowPass:
    """First-order low-pass of six components, spaced as the samples are."""

    def __init__(self, time_constant_s: float) -> None:
        self.time_constant_s = time_constant_s
        self._state: Six | None = None
        self._time_s = 0.0

    def update(self, wrench: Six, time_s: float) -> Six:
        """The filtered wrench after this sample; the first sample starts the filter."""
        state = self._state
        if state is None:
            self._state, self._time_s = wrench, time_s
            return wrench
        gain = -math.expm1(-max(0.0, time_s - self._time_s) / self.time_constant_s)
        self._time_s = time_s
        a, b, c, d, e, f = wrench
        p, q, r, s, t, u = state
        self._state = (
            p + gain * (a - p),
            q + gain * (b - q),
            r + gain * (c - r),
            s + gain * (d - s),
            t + gain * (e - t),
            u + gain * (f - u),
        )
        return self._state

    def reset(self) -> None:
        """Start again at the next sample: the signal has jumped for a reason."""
        self._state = None


class Cusum:
    """Sum of the excess over a drift; falls back to zero when the excess is gone."""

    def __init__(self, settings: CusumTouch) -> None:
        self.value = 0.0
        """The sum that was compared."""
        self._drift, self._threshold = settings.drift_n, settings.threshold_n
        self._sign = settings.sign

    def update(self, force: float) -> bool:
        """Add a sample; True when it completes a touch."""
        self.value = max(0.0, self.value + self._sign * force - self._drift)
        return not self.value <= self._threshold


class Frozen:
    """Counts samples in a row that are equal in all six channels: a live sensor has noise."""

    def __init__(self, samples: int) -> None:
        self.count = 1
        self._samples = samples
        self._last: Six | None = None

    def update(self, raw: Six) -> bool:
        """True when this sample is one too many."""
        self.count = self.count + 1 if raw == self._last else 1
        self._last = raw
        return self.count >= self._samples


class Burst:
    """Counts events of a growing counter within a sliding window."""

    def __init__(self, events: int, window_s: float, start: int) -> None:
        self._events, self._window_s = events, window_s
        self._total = start
        self._times: deque[float] = deque(maxlen=events)

    def update(self, total: int, now_s: float) -> bool:
        """True when enough events fell into the window that ends now."""
        self._times.extend([now_s] * min(total - self._total, self._events))
        self._total = total
        full = len(self._times) == self._events
        return full and now_s - self._times[0] <= self._window_s


class RateWindow:
    """Arrivals a second over consecutive windows."""

    def __init__(self, band_hz: tuple[float, float], window_s: float, now_s: float) -> None:
        self.rate_hz = 0.0
        self._lowest, self._highest = band_hz
        self._window_s = window_s
        self._since_s = now_s
        self._count = 0

    def add(self) -> None:
        """One sample."""
        self._count += 1

    def check(self, now_s: float) -> bool:
        """True when a window ended outside the band."""
        elapsed_s = now_s - self._since_s
        if elapsed_s < self._window_s:
            return False
        self.rate_hz = self._count / elapsed_s
        self._since_s, self._count = now_s, 0
        return not self._lowest <= self.rate_hz <= self._highest

    def excuse(self, seconds: float) -> None:
        """Do not count time in which the whole machine stood still."""
        self._since_s += seconds
