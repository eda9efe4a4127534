"""Which axes give way in a motion, with gains from the figures of the cell."""

import numpy as np

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.streamed_motion import Press
from cellctl.force.contact.streamed.admittance import (
    Admittance,
    AdmittanceBounds,
    AdmittanceGains,
    PushRamp,
)
from cellctl.force.contact.streamed.gains import damping, levers, virtual_mass
from cellctl.force.contact.streamed.speeds import ContactWatch
from cellctl.geometry.pose import Array

X, Y, Z, TILT_X, TILT_Y, YAW = range(6)
_SHARE_OF_STEP = 0.45
"""Share of the step that the controller accepts from tick to tick, for the path."""
_SHIFT_SHARE, _TURN_SHARE = 0.15, 0.2
"""The same for each axis that gives way. Three shifts at right angles add up by √3, and the two
turns that swing the flange about the tip by √2. Together with the path they take 0.45 + 0.15 √3 +
0.2 √2, which is 0.99 of the step. The third turn is about the axis of the flange, on which the tip
lies, and swings nothing."""
_ABOUT_AXES = 0.3
"""Share of the greatest turn from tick to tick for each axis that gives way."""


def fastest_m_s(loop: ContactLoop) -> float:
    """Greatest speed of the tip that the stream follows."""
    return _SHARE_OF_STEP * loop.stream.limits.step_m / loop.period_s


def fastest_rad_s(loop: ContactLoop) -> float:
    """Greatest turning speed about the tip: the flange swings round it on its own lever."""
    return _turning_rad_s(loop, _SHARE_OF_STEP, _SHARE_OF_STEP)


def _turning_rad_s(loop: ContactLoop, share_of_way: float, share_of_turn: float) -> float:
    lever_m = float(np.linalg.norm(loop.frames.flange_T_tip.translation))
    limits = loop.stream.limits
    step_rad = min(
        share_of_way * limits.step_m / max(lever_m, 1e-6), share_of_turn * limits.step_rad
    )
    return step_rad / loop.period_s


def giving_way(
    loop: ContactLoop,
    push: Array,
    follows: tuple[int, ...],
    *,
    spring: Array | None = None,
    contact_must_stay: bool = False,
) -> Press:
    """Admittance of the axes ``follows``; all others stay stiff.

    ``push`` (6,) is the wrench that the peg is to push with, in N and N·m. ``spring`` (6,) in N/m
    and N·m/rad pulls back to the nominal pose. With ``contact_must_stay`` a lost contact is a
    fault.
    """
    settings = loop.settings
    weights = levers(settings.lever_m)
    # One contact can load at most three of them: its normal and its moment lie in one plane.
    gains = AdmittanceGains(
        mass=virtual_mass(settings.figures, weights),
        damping=damping(settings.figures, weights, min(len(follows), 3)),
        spring=np.zeros(6) if spring is None else spring,
        follows=np.isin(np.arange(6), follows),
    )
    admittance = Admittance(gains, _bounds(loop, gains), loop.period_s)
    watch = ContactWatch(float(push[Z]), loop.period_s) if contact_must_stay else None
    return Press(admittance, PushRamp(loop.felt, push, loop.period_s), watch)


def _bounds(loop: ContactLoop, gains: AdmittanceGains) -> AdmittanceBounds:
    settings, lever_m = loop.settings, loop.settings.lever_m
    # Giving way at full speed must not take more than half of the force that is allowed.
    by_force_m_s = 0.5 * settings.limit_n / float(gains.damping[Z])
    by_step_m_s = _SHIFT_SHARE * loop.stream.limits.step_m / loop.period_s
    speed_m_s = min(settings.touch_speed_m_s, by_force_m_s, by_step_m_s)
    speed_rad_s = min(speed_m_s / lever_m, _turning_rad_s(loop, _TURN_SHARE, _ABOUT_AXES))
    way_m = (settings.give_way_m, settings.give_way_m, settings.follow_m)
    return AdmittanceBounds(
        speed=np.repeat([speed_m_s, speed_rad_s], 3),
        acceleration=np.repeat(
            [settings.acceleration_m_s2, settings.acceleration_m_s2 / lever_m], 3
        ),
        way=np.array([*way_m, *(settings.give_way_rad,) * 3]),
    )
