"""Detectors that take one sample at a time: plain floats, no memory beyond a few numbers.

Wherever a NaN could arrive, the comparison is written so that NaN counts as beyond the limit:
``not -limit <= value <= limit`` instead of ``abs(value) > limit``.
"""

import math
from collections import deque
from dataclasses import replace

from cellctl.force.contact.touch_detector import CusumDetector
from cellctl.guard.limits import LONGEST_BRAKING_S, GuardLimits, Six


class ArmedDetectors:
    """The detectors of one arming: made when the guard is armed, dropped when it is disarmed.

    New ones for each arming, so that no count or sum of an earlier one can trip it.
    """

    def __init__(self, limits: GuardLimits, bad_frames: int, now_s: float) -> None:
        self.limits = limits
        """Those that hold at present."""
        self._moving, self._brakes_until_s = limits, now_s
        self.frozen = FrozenDetector(limits.frozen_samples)
        self.rate = RateDetector(limits.rate_hz, limits.rate_window_s, now_s)
        self.touch_axis = limits.touch.axis if limits.touch is not None else 0
        self._touch_sign = limits.touch.sign if limits.touch is not None else 1.0
        self._touch = CusumDetector(limits.touch) if limits.touch is not None else None
        self._bad_frames = BurstDetector(limits.bad_frames, limits.bad_frames_window_s, bad_frames)

    def brake(self, now_s: float) -> None:
        """Widen the limits of the wrench to those of braking, until ``end_of_braking``."""
        braking = self._moving.braking
        if braking is None:
            return
        self.limits = replace(
            self._moving,
            raw=_wider(self._moving.raw, braking),
            filtered=_wider(self._moving.filtered, braking),
        )
        self._brakes_until_s = now_s + LONGEST_BRAKING_S

    def end_of_braking(self, now_s: float) -> None:
        """Go back to the limits of the move once braking has had its time."""
        if self.limits is not self._moving and now_s > self._brakes_until_s:
            self.limits = self._moving

    def touched(self, wrench: Six) -> bool:
        """True when this sample completes a touch."""
        if self._touch is None:
            return False
        return self._touch.update(self._touch_sign * wrench[self.touch_axis])

    def bad_frames(self, total: int, now_s: float) -> bool:
        """True when too many frames were damaged lately; ``total`` counts since the start."""
        return self._bad_frames.update(total, now_s)


class LowPass:
    """First-order low-pass of six components for samples that come at uneven times."""

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
        # 1 - exp(-t/T) is exact for a value that is held between two samples, whatever time t lies
        # between them. A sample time that stands still or goes back has no weight and does not
        # upset the filter.
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
        """Start again at the next sample, because the zero of the signal has changed."""
        self._state = None


class FrozenDetector:
    """Counts samples in a row that are equal in all six channels.

    A live sensor has noise in every channel. A converter that hangs, or a box that repeats its last
    values while its sensor is unplugged, sends good frames that never change.
    """

    def __init__(self, samples: int) -> None:
        self.count = 1
        self._samples = samples
        self._last: Six | None = None

    def update(self, raw: Six) -> bool:
        """True when this sample makes it too many in a row."""
        self.count = self.count + 1 if raw == self._last else 1
        self._last = raw
        return self.count >= self._samples


class BurstDetector:
    """Counts the increments of a growing counter within a sliding window.

    One damaged frame now and then is normal on a serial line; several at once are not.
    """

    def __init__(self, events: int, window_s: float, start: int) -> None:
        self._events, self._window_s = events, window_s
        self._total = start
        # As many times as events are needed: when the queue is full, its oldest entry alone tells
        # whether they all lie within the window.
        self._times: deque[float] = deque(maxlen=events)

    def update(self, total: int, now_s: float) -> bool:
        """True when enough events fell into the window that ends now."""
        # No more entries than the queue holds, so that a counter that jumps by millions costs no
        # time.
        self._times.extend([now_s] * min(total - self._total, self._events))
        self._total = total
        full = len(self._times) == self._events
        return full and now_s - self._times[0] <= self._window_s


class RateDetector:
    """Compares the number of samples a second, in consecutive windows, with an allowed band.

    Time in which the whole machine stood still counts against too many samples, not against too
    few. A box outside of the machine goes on sending, and the samples wait in the socket; what runs
    on the same machine, a fake or a serial server, stands still as well.
    """

    _MOST_EXCUSED = 0.5
    """Share of a window. A machine that is away for more leaves no rate that could be trusted."""

    def __init__(self, band_hz: tuple[float, float], window_s: float, now_s: float) -> None:
        self.rate_hz = 0.0
        """Rate in the window that ended last."""
        self._lowest_hz, self._highest_hz = band_hz
        self._window_s = window_s
        self._since_s = now_s
        self._excused_s = 0.0
        self._count = 0

    def add(self) -> None:
        """Count one sample."""
        self._count += 1

    def check(self, now_s: float) -> bool:
        """True when a window has ended and its rate was outside the band."""
        elapsed_s = now_s - self._since_s
        if elapsed_s < self._window_s:
            return False
        running_s = elapsed_s - min(self._excused_s, self._MOST_EXCUSED * elapsed_s)
        self.rate_hz = self._count / elapsed_s
        enough = self._lowest_hz <= self._count / running_s
        self._since_s, self._excused_s, self._count = now_s, 0.0, 0
        return not (enough and self.rate_hz <= self._highest_hz)

    def excuse(self, seconds: float) -> None:
        """The whole machine stood still for so long and nobody could count."""
        self._excused_s += seconds


def _wider(limits: Six, others: Six) -> Six:
    a, b, c, d, e, f = map(max, limits, others)
    return a, b, c, d, e, f


def beyond(wrench: Six, limits: Six) -> int | None:
    """The first component whose magnitude is beyond its limit; None when all are within.

    The common case, all within, is one chain of comparisons: this runs twice for every sample.
    """
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
    # The same form as above and not ``abs``, so that a NaN is found here too and ``next`` always
    # has a component to give.
    outside = (not -limit <= value <= limit for value, limit in zip(wrench, limits, strict=True))
    return next(index for index, is_outside in enumerate(outside) if is_outside)
