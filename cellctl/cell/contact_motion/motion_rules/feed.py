"""Speed of a feed into the hole, and when the force has stopped it."""

from cellctl.cell.contact_motion.motions import ContactSample, Ended
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.force.contact.streamed.speeds import FEED_N, feed_override, touch_speed_m_s

_STALLED_SHARE = 0.1
"""A feed that the force has slowed to less than this share counts as standing."""
_STALLED_S = 0.3
"""A feed has to stand for this time, so that a chamfer to which the arm is just giving way is not
taken for the end. The exact value only delays the end of a feed that is stuck."""
_LAST_M = 0.5e-3
"""Length of the last stretch before the seat, which is gone at the speed of a touch (section
4.4)."""
_TOUCH_SHARE = 0.8
"""Speed over that stretch, as a share of the feed: a touch may grow by 8 N, a feed by 10 N."""
_UNFELT_SHARE = 0.2
"""The same beyond the depth of the seat, as long as no force is felt. A dead sensor shows no force
either, and then whatever the arm travels until it is stopped turns into force."""
_SLOWEST_SHARE = 0.2
"""Share of the full speed from which the time limit of a feed follows: a part that goes in hard
slows the feed for most of its way."""


class FeedRule:
    """One feed to a seat at ``depth_m``. Section 4.4 of the study of insertion by touch."""

    def __init__(
        self, figures: LoopFigures, limit_n: float, depth_m: float, period_s: float
    ) -> None:
        # Half of the limit is the most by which the study lets a feed grow before the arm has
        # answered; a limit below 20 N leaves less than the usual 10 N.
        self._full_m_s = touch_speed_m_s(figures, min(FEED_N, 0.5 * limit_n))
        self._limit_n, self._depth_m = limit_n, depth_m
        self._most = _STALLED_S / period_s
        self._ticks = 0

    @property
    def slowest_m_s(self) -> float:
        """Speed from which the time limit of the feed follows."""
        return _SLOWEST_SHARE * self._full_m_s

    def speed_m_s(self, sample: ContactSample) -> float:
        """Speed of the next tick; negative to back off."""
        override = feed_override(_axial_n(sample), self._limit_n)
        left_m = self._depth_m - float(sample.task_position_tip_m[2])
        if left_m < 0.0 and override == 1.0:
            return self._full_m_s * _UNFELT_SHARE
        return self._full_m_s * (_TOUCH_SHARE if left_m < _LAST_M else 1.0) * override

    def stalled(self, sample: ContactSample) -> Ended | None:
        """``FORCE`` once the feed has stood for a while, or the limit is passed."""
        share = feed_override(_axial_n(sample), self._limit_n)
        self._ticks = self._ticks + 1 if share < _STALLED_SHARE else 0
        passed = _axial_n(sample) > self._limit_n
        return Ended.FORCE if passed or self._ticks > self._most else None


def _axial_n(sample: ContactSample) -> float:
    return -float(sample.force_n[2])
