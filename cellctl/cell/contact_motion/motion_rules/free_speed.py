"""How fast a motion through free space may be, in case it meets something after all."""

from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.force.contact.streamed.speeds import met_speed_m_s

_MET_RATIO = 0.9
"""Share of a limit that a contact which nobody expected may take; the rest is for noise. The
stiffness is a bound already."""
_LEAST_RATIO = 0.1
"""Least growth of the force that is counted with, as a share of the limit. Where the limit is
hardly above the force that counts as a contact, the difference of the two would leave no speed at
all."""
_LEVEL = 1e-3
"""A way that descends by less than this share of its length counts as level: it cannot meet a face
below it."""


def free_speed_m_s(
    settings: ContactSettings, watched_n: float, from_m: float, to_m: float, way_m: float
) -> float:
    """Greatest speed along a way of ``way_m`` from one depth below the face to another.

    An obstacle that nobody expects is met with no more than the limit of all motions. The part with
    the hole is met with no more than ``watched_n``, at which the guard stops the arm. Over its face
    the part lies below the way, so only the share of the speed that descends counts; under its face
    it lies beside the way, and the whole speed counts.
    """
    sinks = 1.0 if max(from_m, to_m) > 0.0 else max(to_m - from_m, 0.0) / way_m
    anything_m_s, part_m_s = (_meets_m_s(settings, n) for n in (settings.limit_n, watched_n))
    return min(anything_m_s, part_m_s / max(sinks, _LEVEL))


def _meets_m_s(settings: ContactSettings, limit_n: float) -> float:
    # A motion in the free ends where the force is that of a press.
    growth_n = max(_MET_RATIO * limit_n - settings.press_n, _LEAST_RATIO * limit_n)
    return met_speed_m_s(settings.figures, growth_n, settings.acceleration_m_s2)
