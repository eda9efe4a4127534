"""Turns a keyed plug until its keys drop into their keyways.

Source: S4k in section 2 of the study of insertion by touch.
"""

from math import radians

import numpy as np

from cellctl.cell.contact_motion.motions import Condition, ContactMotions, ContactSample, Ended
from cellctl.processes.peg_in_hole.faults import KeywayNotFound
from cellctl.processes.peg_in_hole.plan.task import KeyGeometry, SearchTask
from cellctl.processes.peg_in_hole.search.conditions import LostSupport

_HOLD_N, _FASTEST_RAD_S = 5.0, radians(3.0)
"""Press during the sweep, and its greatest speed (section 2, S4k)."""
_SWEEP_RATIO = 1.5
"""How far the sweep goes, over the uncertainty of the turn: that figure is an estimate itself."""
_BEGUN_M = 0.2e-3
"""A drop by which the keys are seen to have begun to enter."""
_SETTLE_S = 1.0
"""Longest time in which the keys centre themselves, and again in which the arm loses its twist."""
_UNTWISTED_N_M = 0.1
"""Moment about the axis that counts as none: far below what the verdict takes for a key that
resists."""
_THROUGH_RATIO = 0.5
"""How much further than the ends of the keys the plug must go, over the depth of the keys."""
_NEAR_M = 0.5e-3
"""A plug that stands within this distance of the depth of its keys stands on them."""
_DAMPING = 1.5
"""Factor of the admittance's damping along z (force/contact/streamed/gains.py)."""


def sweep_rad(keys: KeyGeometry) -> float:
    """How far the plug is turned to either side."""
    return _SWEEP_RATIO * keys.uncertainty_rad


async def find_keyway(motions: ContactMotions, task: SearchTask, keys: KeyGeometry) -> None:
    """From the entry of the hole to below the ends of the keyways; raises ``KeywayNotFound``.

    Turns to both sides while it is pressed lightly, and lets the keys centre themselves where they
    begin to drop. A plug that stands short of its keys is left to the recoveries of the insertion.
    """
    through_m = (1.0 + _THROUGH_RATIO) * keys.depth_m
    motion = await motions.feed(through_m, task.limits.search_n)
    greatest_rad = sweep_rad(keys)
    for target_rad in (greatest_rad, -greatest_rad):
        # Through, or stopped by something else than the keys, which turning would not help.
        if motion.ended is not Ended.FORCE or not _on_keys(motion.last, task, keys):
            return
        motion = await motions.turn(
            np.array([0.0, 0.0, target_rad]),
            np.array([0.0, 0.0, _HOLD_N]),
            _sweep_speed_rad_s(task, keys),
            _dropped_from(float(motion.last.task_position_tip_m[2]), task),
        )
        # Keys that have dropped leave nothing that carries the plug: it would sink on and on.
        await motions.comply(_HOLD_N, _SETTLE_S, LostSupport(_HOLD_N))
        # The turn ends against a flank of the keyways, and the feed to the seat is stiff about z.
        await motions.comply(0.0, _SETTLE_S, _untwisted)
        motion = await motions.feed(through_m, task.limits.search_n)
    if motion.ended is Ended.FORCE and _on_keys(motion.last, task, keys):
        raise KeywayNotFound(
            f"turned by {np.degrees(greatest_rad):.1f} degrees to both sides at a depth of "
            f"{float(motion.last.task_position_tip_m[2]) * 1e3:.2f} mm"
        )


def _sweep_speed_rad_s(task: SearchTask, keys: KeyGeometry) -> float:
    """A speed so low that the plug drops visibly while the keys cross half of their window."""
    drop_m_s = _HOLD_N / (_DAMPING * task.cell.loop_n_s_m)
    return min(_FASTEST_RAD_S, keys.window_rad * drop_m_s / _BEGUN_M)


def _untwisted(sample: ContactSample) -> bool:
    return abs(float(sample.moment_n_m[2])) < _UNTWISTED_N_M


def _dropped_from(depth_m: float, task: SearchTask) -> Condition:
    # Under the press of the feed the arm had yielded by more than it does under this one.
    released_m = max(task.limits.search_n - _HOLD_N, 0.0) / task.cell.stiffness_n_m

    def dropped(sample: ContactSample) -> bool:
        return float(sample.task_position_tip_m[2]) > depth_m - released_m + _BEGUN_M

    return dropped


def _on_keys(sample: ContactSample, task: SearchTask, keys: KeyGeometry) -> bool:
    """Whether the tip is at the depth of the keys, less what arm and contact yield."""
    yields_m = -float(sample.force_n[2]) / task.cell.stiffness_n_m
    return abs(float(sample.task_position_tip_m[2]) - yields_m - keys.depth_m) < _NEAR_M
