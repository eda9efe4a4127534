"""Sample times from arrival times, without the jitter of the transport.

A sample cannot arrive before it was taken, and the least delayed one of many arrives almost at
once. So the estimate runs ahead at the device's pace and is tied to the earliest arrivals.
"""

_WINDOW_S = 0.5
"""Stretch over which phase and pace are estimated: long enough to hold samples that came at once,
short against the drift of the two clocks."""
_PAUSE_S = 0.25
"""An estimate this far behind has missed a pause of the stream: start from the arrival again."""

_BACKLOG_S = 0.02
"""A sample this much earlier than estimated is one of those that a pause has held back."""
_PACE_DOUBT = 0.02
"""Relative difference between the pace of the phases and that of the arrivals, from which on the
phases are not believed."""


class SampleClock:
    """One stream of equally spaced samples; restart it when the numbering restarts."""

    def __init__(self, rate_hz: float, tolerance: float) -> None:
        self.rate_hz = 0.0
        """Measured over the last window; 0 before the first one ended."""
        self.lag_s = 0.0
        """How much later than they were taken samples arrive, as far as pauses of the stream show
        it: what a pause has held back, and nothing has made up for within a window."""
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
        """What pauses have held back and nothing has made up for: now, and a window ago."""
        self.lag_s = 0.0

    def stamp(self, receive_s: float, periods: int, behind: int = 0) -> float:
        """Time of a sample that came ``periods`` after the one before.

        ``behind`` says how many samples came after it in the same read: it was not taken later
        than so many periods before the read.
        """
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
        # A sample cannot arrive before it was taken, so the estimate was late; far behind, it has
        # missed a pause.
        if delay_s < 0.0 or delay_s > _PAUSE_S:
            paused = bound_s - before_s > _PAUSE_S
            if paused or self._jumped_s > 0.0:
                # No sample is missing, or ``periods`` would say so: those behind the pause wait
                # somewhere, until what arrives faster than it is taken has made up for it.
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
        """Tie the phase to the least delayed sample, learn the pace, judge the rate.

        The tied phases give the pace finely, plain arrivals give it whatever the pace was before.
        """
        # Not at once: what one read has left in the socket, the next one catches up with.
        self.lag_s = min(self._jumped_s, self._jumped_before_s)
        # Each pause is judged by itself: a sum over hours would grow with every hiccup of a PC.
        self._jumped_s -= self.lag_s
        self._jumped_before_s = self._jumped_s
        self._estimate_s += self._least_delay_s
        if self._origin_s is not None:
            fine_s = (self._estimate_s - self._origin_s) / self._periods
            coarse_s = (bound_s - self._arrival_origin_s) / self._periods
            # The fine pace rests on the phase before. When the pace itself was wrong, so was that
            # phase, and only the plain arrivals are to be trusted.
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
