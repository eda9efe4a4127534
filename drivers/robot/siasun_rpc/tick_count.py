"""Ticks of a stream whose controller has none of its own: the PC counts them."""

import math
from dataclasses import dataclass

_GRACE = 0.5
"""Of a period: a PC that comes so late to a tick begins it then. That is the age from which a
motion slows for a late tick, so that nothing is sent that would count as one."""


@dataclass(slots=True)
class TickCount:
    """One tick in each period. None is shorter, so that a setpoint is never followed faster."""

    period_s: float
    began_s: float
    """Beginning of the first tick, by the times of those that came later than they should."""
    tick: int = 1
    """Number of the present tick."""
    lost: int = 0
    """Ticks that went by without anybody who looked."""

    @property
    def end_s(self) -> float:
        """End of the present tick."""
        return self.began_s + self.tick * self.period_s

    def begin_next(self, now_s: float) -> float:
        """Count the next tick that can still be used; its beginning, which is now or later.

        On a grid that stays where it is, a PC that needs a little more than a period for each of
        its setpoints would miss every second tick.
        """
        behind_s = now_s - self.end_s
        if 0.0 < behind_s <= _GRACE * self.period_s:
            self.began_s += behind_s
            behind_s = 0.0
        gone = max(0, math.ceil(behind_s / self.period_s))
        self.lost += gone
        self.tick += 1 + gone
        return self.end_s - self.period_s
