"""Detects a force that acts with the feed, which no hole makes: a hole only holds a peg back.

A sensor that shows such a force has lost its zero or has another sign, and the arm then pushes
harder than the sensor shows. Source: frame_or_sign in section 5.2 of the study of insertion by
touch.
"""

from collections import deque
from collections.abc import Sequence

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.felt import LEAST_SLOPE
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedCell

LEAST_SIGN_N = 2.0
"""A smaller force along the axis says nothing about its sign."""
_LEAST_SIGMAS = 8.0
"""Noise makes no change of this many standard deviations (sensor_spike of section 5.2)."""
_IN_A_ROW = 3
"""Fewer samples are a spike."""


def most_with_feed_n(cell: JudgedCell) -> float:
    """Greatest force (N) with the feed that a good insertion may show."""
    return max(LEAST_SIGN_N, _LEAST_SIGMAS * cell.force_sigma_n)


class ForceWithFeed:
    """Takes the samples of one feed, and knows the greatest force that has acted with it."""

    def __init__(self, cell: JudgedCell) -> None:
        self._cell = cell
        self._counts_from_m: float | None = None
        self._latest_n: deque[float] = deque(maxlen=_IN_A_ROW)
        self.greatest_n = 0.0
        """Shown by three samples in a row."""

    def take(self, sample: ContactSample) -> bool:
        """Take the next sample; True when the force with the feed shows that the sensor is
        wrong."""
        depth_m, with_feed_n = float(sample.task_position_tip_m[2]), float(sample.force_n[2])
        if self._counts_from_m is None:
            # A peg that was drawn back is held by its walls until the arm has come back by what
            # they had made it yield.
            yields_m = max(with_feed_n, 0.0) / (LEAST_SLOPE * self._cell.stiffness_n_m)
            self._counts_from_m = depth_m + yields_m
        if depth_m >= self._counts_from_m:
            self._latest_n.append(with_feed_n)
        if len(self._latest_n) == _IN_A_ROW:
            self.greatest_n = max(self.greatest_n, min(self._latest_n))
        return self.greatest_n > most_with_feed_n(self._cell)


def with_feed_n(feed: Sequence[ContactSample], cell: JudgedCell) -> float:
    """The greatest force that has acted with a feed, shown by three samples in a row."""
    watched = ForceWithFeed(cell)
    for sample in feed:
        watched.take(sample)
    return watched.greatest_n
