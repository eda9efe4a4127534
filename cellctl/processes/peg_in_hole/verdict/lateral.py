"""Pushes the peg to all four sides: between walls it resists, on a face it slides."""

import numpy as np

from cellctl.cell.contact_motion.motions import ContactMotion, ContactMotions, Ended
from cellctl.processes.peg_in_hole.plan.task import CellFigures, SearchTask
from cellctl.processes.peg_in_hole.verdict.evidence import LateralCapture

_PRESS_N = 2.0
_SPEED_M_S = 0.5e-3
_LEAST_PUSH_N = 3.0
_MARGIN_M = 0.1e-3
_SETTLE_S = 1.0
"""The arm comes back by what it had yielded under the force of the seat."""


def push_force_n(cell: CellFigures) -> float:
    """More than friction, and more than the slope of a chamfer, could resist with."""
    # How much a 45° chamfer with this friction holds against a push, as a multiple of what presses
    # on it: the tangent of 45° and the angle of friction together.
    slope = (1 + cell.friction) / (1 - cell.friction)
    return max(_LEAST_PUSH_N, 2 * _PRESS_N * slope) + 1.3 * cell.force_sigma_n


async def measure_capture(motions: ContactMotions, task: SearchTask) -> LateralCapture:
    """Push along x and back, along y and back, pressed lightly; the arm stays where it ends."""
    push_n = push_force_n(task.cell)
    yields_m = push_n / task.cell.stiffness_n_m
    begun = (await motions.press(_PRESS_N, _SETTLE_S)).last
    pushes: list[ContactMotion] = []
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            direction = np.zeros(3)
            direction[axis] = sign
            # The second push begins at the first contact and so has to undo what yielded there.
            way_m = 2 * task.fit.clearance_m + 2 * yields_m + 2 * _MARGIN_M
            pushes.append(await motions.touch(direction, way_m, push_n, _SPEED_M_S))
    depths = [push.last.task_position_tip_m[2] for push in pushes]
    forces = np.array([push.last.force_n for push in pushes])
    # Between two opposite pushes the force must change by both of them. A sensor that is dead shows
    # the same twice.
    change_n = max(np.ptp(forces[:2, 0]), np.ptp(forces[2:, 1]))
    return LateralCapture(
        resisted=sum(push.ended is Ended.FORCE for push in pushes),
        play_x_m=_play_m(pushes[0], pushes[1], 0, yields_m),
        play_y_m=_play_m(pushes[2], pushes[3], 1, yields_m),
        depth_change_m=float(max(abs(depth - begun.task_position_tip_m[2]) for depth in depths)),
        force_change_sigmas=float(change_n / task.cell.force_sigma_n),
    )


def _play_m(
    first: ContactMotion, second: ContactMotion, axis: int, yields_m: float
) -> float | None:
    if not first.ended is second.ended is Ended.FORCE:
        return None
    apart = first.last.task_position_tip_m[axis] - second.last.task_position_tip_m[axis]
    # Each push ends beyond its wall by what the arm yields under it.
    return float(apart) - 2 * yields_m
