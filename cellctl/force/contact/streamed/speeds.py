"""Speeds in contact: each follows from what the force may grow before the arm has answered.

Source: sections 1, 3.2 and 4.4 of the study of insertion by touch.
"""

import numpy as np

from cellctl.force.contact.streamed.gains import LoopFigures

DETECTION_S = 0.03
"""A lost or a new contact is believed after so long."""
FASTEST_TOUCH_M_S = 3e-3
FEED_N = 10.0
"""By which the force of a feed may grow before the arm has answered."""
LOST_SHARE = 0.3
"""Of the press: less than that counts as no contact."""
LOST_S = 0.02


def touch_speed_m_s(figures: LoopFigures, growth_n: float) -> float:
    """Greatest speed of a touch at which its contact grows by no more than ``growth_n``."""
    return min(FASTEST_TOUCH_M_S, met_speed_m_s(figures, growth_n))


def met_speed_m_s(figures: LoopFigures, growth_n: float) -> float:
    """The same for a contact that nobody expects: no touch, so nothing else bounds it."""
    delay_s = figures.dead_time_s + DETECTION_S
    return growth_n / (figures.stiffness_n_m * delay_s)


def feed_override(axial_n: float, limit_n: float) -> float:
    """Share of the feed, from −0.5 to 1: full below 12 % of the limit, nought at 60 %.

    ``axial_n`` is the force that the hole exerts against the feed.
    """
    return float(np.clip(1.25 * (1.0 - axial_n / (0.6 * limit_n)), -0.5, 1.0))


class ContactWatch:
    """Tells whether a press still presses on something."""

    def __init__(self, press_n: float, period_s: float) -> None:
        self._least_n = LOST_SHARE * press_n
        self._ticks = LOST_S / period_s
        self._below = 0

    def lost(self, axial_n: float) -> bool:
        """Take the force of a tick; True while it has been too small for ``LOST_S``."""
        self._below = self._below + 1 if axial_n < self._least_n else 0
        return self._below >= self._ticks
