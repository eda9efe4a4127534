"""Speeds in contact: each follows from what the force may grow before the arm has answered.

Source: sections 1, 3.2 and 4.4 of the study of insertion by touch.
"""

from math import sqrt

import numpy as np

from cellctl.force.contact.streamed.gains import LoopFigures

DETECTION_S = 0.03
"""A contact that is new, or that is lost, is believed when it has lasted for this time (t_det of
section 3.2)."""
FASTEST_TOUCH_M_S = 3e-3
"""No touch is faster than this, however soft the contact (section 1)."""
FEED_N = 10.0
"""Force by which a feed may grow before the arm has answered (ΔF of section 4.4)."""
LOST_SHARE = 0.3
"""A force below this share of the wanted press counts as no contact (section 4.2)."""
LOST_S = 0.02
"""A contact is lost when the force has been that small for this time (section 4.2)."""


def touch_speed_m_s(figures: LoopFigures, growth_n: float) -> float:
    """Speed (m/s) of a touch whose contact grows by no more than ``growth_n`` until it is noticed
    and answered."""
    delay_s = figures.dead_time_s + DETECTION_S
    return min(FASTEST_TOUCH_M_S, growth_n / (figures.stiffness_n_m * delay_s))


def met_speed_m_s(figures: LoopFigures, growth_n: float, acceleration_m_s2: float) -> float:
    """Speed (m/s) of a motion in the free that ends at its first contact: by so much the force
    grows until the arm stands.

    It goes on for the dead time, and then brakes with its acceleration: ΔF = k (v θ + v² / 2a). It
    may be faster than a touch, as no time is needed to believe the contact.
    """
    dead_s, a = figures.dead_time_s, acceleration_m_s2
    way_m = growth_n / figures.stiffness_n_m
    return a * (sqrt(dead_s**2 + 2.0 * way_m / a) - dead_s)


def feed_override(axial_n: float, limit_n: float) -> float:
    """Share of the full feed speed, from −0.5 to 1: 1 below 12 % of the limit, 0 at 60 %.

    ``axial_n`` is the force that the hole exerts against the feed. Above 60 % the share is negative
    and the feed backs off. A feed that only stopped at a threshold ended on the chamfer in 7 of 12
    simulated insertions; one that slows with the force gives the lateral axes the time to follow
    (section 4.4).
    """
    return float(np.clip(1.25 * (1.0 - axial_n / (0.6 * limit_n)), -0.5, 1.0))


class ContactWatch:
    """Tells from tick to tick whether a press still presses on something."""

    def __init__(self, press_n: float, period_s: float) -> None:
        self._least_n = LOST_SHARE * press_n
        self._ticks = LOST_S / period_s
        self._below = 0

    def lost(self, axial_n: float) -> bool:
        """Take the force of a tick; True while it has been too small for ``LOST_S``."""
        self._below = self._below + 1 if axial_n < self._least_n else 0
        return self._below >= self._ticks
