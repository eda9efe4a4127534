"""What a streamed contact is given: figures of the cell, size of the peg, limits of the forces."""

from dataclasses import dataclass

import numpy as np

from cellctl.force.contact.streamed.gains import (
    LoopFigures,
    check_load,
    check_press,
    check_speed,
    contact_load,
    damping,
    levers,
)
from cellctl.force.contact.streamed.speeds import touch_speed_m_s
from cellctl.geometry.pose import Array

_Z = 2


@dataclass(frozen=True, slots=True)
class ContactSettings:
    """Nothing here is a gain: those follow from the figures."""

    figures: LoopFigures
    lever_m: float
    """Radius of the peg: the lever of a contact at its rim."""
    press_n: float
    """The press of the search, which must be able to move the arm."""
    limit_n: float
    """A force that no motion may reach, and that the guard stops at."""
    limit_n_m: float
    """The same for a moment about any axis of the tip."""
    lateral_spring_n_m: float = 5e3
    """K sideways while the peg is fed, as simulated in section 4.3 of the study of insertion by
    touch."""
    rim_spring_n_m: float = 5.6e5
    """K of the attitude while the peg is fed, at the rim: 5 N·m/rad for a peg of 6 mm (section
    4.3)."""
    filter_s: float = 2e-3
    """Time constant of the low-pass before the law; part of the dead time."""
    acceleration_m_s2: float = 0.1
    """Greatest acceleration of the tip. The speeds are a few mm/s, which it reaches within tens of
    milliseconds, so that it shortens no motion and spares the arm a jerk."""
    acceleration_rad_s2: float = 1.0
    """The same for turns, at a lever of 0.1 m."""
    follow_m: float = 3e-3
    """How far the tip may follow a press: vision knows the place of a face to 3 mm (section 1)."""
    give_way_m: float = 1.5e-3
    """How far it may give way sideways: what is expected, and 0.5 mm (section 4.2)."""
    give_way_rad: float = 0.052
    """How far it may give way in attitude: 3°, more than the 2° that vision may leave."""
    fastest_retreat_m_s: float = 5e-3
    """Greatest speed out of contact. Nothing grows there; a peg that is held after all is noticed
    by its pull."""
    lost_tick_s: float | None = None
    """See ``TickRules``."""
    old_force_s: float = 5e-3
    """See ``TickRules``."""
    lost_force_s: float = 20e-3
    """See ``TickRules``."""

    @property
    def springs(self) -> Array:
        """K of each axis while the peg is fed, N/m and N·m/rad, shape (6,); 0 along and about z."""
        # Of the attitude by the lever at the rim: a wide plug would tilt at its seat else.
        lateral, tilt = self.lateral_spring_n_m, self.rim_spring_n_m * self.lever_m**2
        return np.array([lateral, lateral, 0.0, tilt, tilt, 0.0])

    def check(self) -> None:
        """Raise ``LoopTooSlow`` or ``LoopUnstable`` before any contact."""
        weights = levers(self.lever_m)
        # A press on a face gives way along z alone. On a chamfer one contact loads z, a side and a
        # turn, and all axes give way, with three times the damping. Either has to leave its margin.
        along_z, all_axes = np.arange(6) == _Z, weights > 0
        for axes, follows in ((1, along_z), (3, all_axes)):
            every = damping(self.figures, weights, axes)
            check_load(contact_load(self.figures, self.lever_m, every, follows))
        alone_n_s_m = float(damping(self.figures, weights, 1)[_Z])
        check_press(self.figures, self.press_n, alone_n_s_m)
        check_speed(self.touch_speed_m_s, alone_n_s_m, self.limit_n)

    @property
    def touch_speed_m_s(self) -> float:
        """Speed at which a new contact grows by no more than the press."""
        return touch_speed_m_s(self.figures, self.press_n)
