"""Sample times from arrival times, without the jitter of the transport.

A sample cannot arrive before it was taken, and the least delayed one of many arrives almost at
once. So the estimate goes on by one period of the device for each sample, and at the end of each
window it is shifted to the sample that has arrived with the least delay.
"""

_WINDOW_S = 0.5
"""Stretch over which phase and pace are estimated: long enough to hold samples that came at once,
short against the drift of the two clocks."""
_PAUSE_S = 0.25
"""An estimate this far behind the arrivals has missed a pause of the stream: it begins anew at the
arrival."""
_BACKLOG_S = 0.02
"""A sample that arrives this much earlier than estimated is one of those that a pause has held
back."""
_PACE_DOUBT = 0.02
"""Largest relative difference between the period that follows from the estimates and that from the
arrivals. Beyond it the estimates are not believed."""


class SampleClock:
    """One stream of equally spaced samples; restart it when the numbering restarts."""

    def __init__(self, rate_hz: float, tolerance: float) -> None:
        self.rate_hz = 0.0
        """Measured over the last window; 0 before the first one ended."""
        self.lag_s = 0.0
        """How late the samples arrive because of a pause of the stream: what the pause has held
        back and the samples after it have not made up for within a window."""
        self.deviations = 0
        """Windows outside the tolerance."""
        self._nominal_hz = rate_hz
        self._tolerance = tolerance
        self.restart()

    def restart(self) -> None:
        """Forget the phase; the next sample is the first again."""
        self._period_s = 1.0 / self._nominal_hz
        self._estimate_s = 0.0
        self._last_s = 0.0
        self._bound_s = 0.0
        self._started = False
        self._origin_s: float | None = None
        self._arrival_origin_s = 0.0
        self._periods = 0
        self._least_delay_s = 0.0
        self._jumped_s = self._jumped_before_s = 0.0
        """Time that pauses have held samples back and that nothing has made up for yet: now, and at
        the end of the window before."""
        self.lag_s = 0.0

    def stamp(self, receive_s: float, periods: int, behind: int = 0) -> float:
        """Time of a sample that came ``periods`` after the one before.

        ``behind`` says how many samples came after it in the same read: it was not taken later
        than so many periods before the read.
        """
        # The latest time at which this sample can have been taken.
        bound_s = receive_s - behind * self._period_s
        if not self._started:
            self._started = True
            self._estimate_s = self._last_s = self._bound_s = bound_s
            self._least_delay_s = float("inf")
            return bound_s
        before_s, self._bound_s = self._bound_s, bound_s
        self._estimate_s += periods * self._period_s
        self._periods += periods
        delay_s = bound_s - self._estimate_s
        # Negative: the sample arrived before the time that was estimated for it, so the estimate is
        # late. Far too large: the estimate has missed a pause. Both make it begin anew here.
        if delay_s < 0.0 or delay_s > _PAUSE_S:
            paused = bound_s - before_s > _PAUSE_S
            if paused or self._jumped_s > 0.0:
                # No sample is missing, or ``periods`` would say so. So the samples from the pause
                # wait in some buffer, and arrive late until the stream has caught up with them.
                self._jumped_s = max(0.0, self._jumped_s + delay_s)
                if paused or delay_s < -_BACKLOG_S:
                    # Neither a pause nor the rush after it says anything about the pace.
                    self._begin_window(None, bound_s)
            self._estimate_s = bound_s
            delay_s = 0.0
        self._least_delay_s = min(delay_s, self._least_delay_s)
        if self._periods >= _WINDOW_S * self._nominal_hz:
            self._end_window(bound_s)
        # Times never stand still or run backwards, whatever the estimate does: rates and filters
        # divide by their difference.
        self._last_s = max(self._estimate_s, self._last_s + 0.01 * self._period_s)
        return self._last_s

    def _end_window(self, bound_s: float) -> None:
        """Shift the estimate to the least delayed sample, learn the period, judge the rate.

        The estimates of two windows give the period finely, but only if it was nearly right before;
        the plain arrivals give it roughly, whatever it was.
        """
        # The smaller of two windows: what one read has left in the socket, the next catches up
        # with.
        self.lag_s = min(self._jumped_s, self._jumped_before_s)
        # Each pause is judged by itself: a sum over hours would grow with every hiccup of a PC.
        self._jumped_s -= self.lag_s
        self._jumped_before_s = self._jumped_s
        self._estimate_s += self._least_delay_s
        if self._origin_s is not None:
            fine_s = (self._estimate_s - self._origin_s) / self._periods
            coarse_s = (bound_s - self._arrival_origin_s) / self._periods
            # The fine period rests on the estimate of the window before. If the period was wrong,
            # so was that estimate, and only the plain arrivals can be trusted.
            self._period_s = fine_s if abs(fine_s / coarse_s - 1.0) < _PACE_DOUBT else coarse_s
            self.rate_hz = 1.0 / self._period_s
            if abs(self.rate_hz / self._nominal_hz - 1.0) > self._tolerance:
                self.deviations += 1
        self._begin_window(self._estimate_s, bound_s)

    def _begin_window(self, origin_s: float | None, bound_s: float) -> None:
        self._origin_s = origin_s
        self._arrival_origin_s = bound_s
        self._periods = 0
        self._least_delay_s = float("inf")
