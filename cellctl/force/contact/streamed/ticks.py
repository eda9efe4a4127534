"""What late ticks and old forces do to a motion: it slows, stands, and at last is given up.

Travel that was lost is never made up for, because catching up is a jump; a force is never
extrapolated, because in contact it may have turned round. Source: section 4.2 of the study of
insertion by touch.
"""

from dataclasses import dataclass
from enum import StrEnum

from cellctl.errors.streamed_contact import StreamLate

_LATE, _VERY_LATE, _LOST = 1.5, 3.0, 10.0
"""Ages of a tick, in periods, up to which it is in time, up to which the last target is held, and
after which the stream is lost (section 4.2)."""
_LOST_S = 0.05
"""A stream without a tick for this time is lost, however slow its period is."""


class Pace(StrEnum):
    """How the setpoint of a tick follows."""

    STEP = "step"
    HOLD = "hold"
    """The same target again, and half the speed."""
    BRAKE = "brake"
    """Slow down towards standstill."""


@dataclass(frozen=True, slots=True)
class TickRules:
    """Ages from which on a motion slows or ends."""

    period_s: float
    lost_s: float | None = None
    """A tick after this time ends the stream; None: after 50 ms or ten periods."""
    old_force_s: float = 5e-3
    """Age of the newest force at which the motion slows down: five samples at 1 kHz are missing."""
    lost_force_s: float = 20e-3
    """Age of the newest force at which the motion is given up (section 4.2)."""

    def pace(self, tick_age_s: float, force_age_s: float) -> Pace:
        """How to go on after a tick; raises ``StreamLate``."""
        lost_s = min(_LOST * self.period_s, _LOST_S) if self.lost_s is None else self.lost_s
        if tick_age_s > lost_s:
            raise StreamLate(
                f"{tick_age_s * 1e3:.0f} ms between two ticks of a stream of "
                f"{self.period_s * 1e3:.0f} ms"
            )
        if force_age_s > self.lost_force_s:
            raise StreamLate(f"the newest force is {force_age_s * 1e3:.0f} ms old")
        # A tick that is late gets the target of the one before, and so makes up for nothing. One
        # that is later still brings the arm to rest, as a force does by which nobody can steer any
        # more.
        if tick_age_s > _VERY_LATE * self.period_s or force_age_s > self.old_force_s:
            return Pace.BRAKE
        return Pace.HOLD if tick_age_s > _LATE * self.period_s else Pace.STEP
