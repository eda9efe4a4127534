"""Turns and pulls a part that keys and contacts should hold."""

from math import radians

import numpy as np

from cellctl.cell.contact_motion.motions import ContactMotions, ContactSample, Ended, never
from cellctl.processes.peg_in_hole.plan.task import KeyGeometry, SearchTask

_PRESS_N = 2.0
"""Light press during the tests, as in the pushes to the sides (section 5.4 of the study of
insertion by touch)."""
_TURN_RAD_S = radians(1.0)
"""Speed of a turn: at this pace the moment of a key grows slowly against the dead time of the
arm."""
MET_N_M = 0.4
"""Far above what friction at the wall makes, far below what bends a key."""
_BEYOND_RAD = radians(1.5)
"""What arm and fingers yield under that moment, and what the attitude is uncertain by."""
_MARGIN_M = 0.3e-3
"""Way of a pull beyond what arm and contact yield under it. A part that is held does not come that
far."""
_SETTLE_S = 0.5
"""Length of the press before the turns and after the pull, in which the arm comes to rest."""


def telling_turn_rad(keys: KeyGeometry) -> float:
    """A turn from anywhere in its play that a part held by its keys does not make."""
    return 2 * keys.window_rad + _BEYOND_RAD


async def directions_that_resist_a_turn(motions: ContactMotions, keys: KeyGeometry) -> int:
    """How many of the two directions resist; the part is left at the angle at which it was."""
    begun = (await motions.press(_PRESS_N, _SETTLE_S, never)).last
    upright = np.array([0.0, 0.0, float(begun.task_rotation_tip_rad[2])])
    # Only the change counts: the moment that is there before the turn is none of the keys.
    free_n_m = float(begun.moment_n_m[2])
    hold = np.array([0.0, 0.0, _PRESS_N])

    def met(sample: ContactSample) -> bool:
        return abs(float(sample.moment_n_m[2]) - free_n_m) > MET_N_M

    resisted = 0
    for sign in (1.0, -1.0):
        target = upright + np.array([0.0, 0.0, sign * telling_turn_rad(keys)])
        turned = await motions.turn(target, hold, _TURN_RAD_S, met)
        resisted += turned.ended is Ended.CONDITION
        # Back each time, so that both directions begin from the same angle and the part stays as it
        # was.
        await motions.turn(upright, hold, _TURN_RAD_S)
    return resisted


async def pull_that_holds_n(motions: ContactMotions, task: SearchTask, pull_n: float) -> float:
    """The pull in N that the part has held; if it came along, only what was felt then."""
    way_m = pull_n / task.cell.stiffness_n_m + _MARGIN_M
    pulled = await motions.touch(np.array([0.0, 0.0, -1.0]), way_m, pull_n)
    held_n = float(pulled.last.force_n[2])
    # A part that has come along lies where it is pressed back to.
    await motions.press(_PRESS_N, _SETTLE_S, never)
    return held_n
