"""Pushes the peg to its sides: between walls it resists, on a face it slides."""

from collections.abc import Mapping
from math import isnan, nan

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import SOFTEST, least_change_n
from cellctl.cell.contact_motion.motions import (
    ContactMotion,
    ContactMotions,
    ContactSample,
    Ended,
    Vector,
)
from cellctl.processes.peg_in_hole.plan.parameters import touch_speed_m_s
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.conditions import LostSupport
from cellctl.processes.peg_in_hole.verdict.answer import (
    MARGIN_M,
    NothingFelt,
    sensor_answers,
)
from cellctl.processes.peg_in_hole.verdict.evidence import LateralCapture
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedCell, JudgedTask
from cellctl.processes.peg_in_hole.verdict.yielding import yielded_m

_PRESS_N, _FASTEST_M_S, _LEAST_PUSH_N = 2.0, 0.5e-3, 3.0
"""Press along the axis during the pushes, their greatest speed, and their least force (section 5.4,
item 3, of the study of insertion by touch)."""
_SPARE_SHARE = 0.5
"""Share of the force between push and limit by which a push may grow until the arm has answered."""
_SETTLE_S = 1.0
"""The arm comes back by what it had yielded under the force of the seat."""

Side = tuple[int, float]
"""Axis (0 for x, 1 for y) and sign of a push."""
SIDES: tuple[Side, ...] = ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))
"""The sides in the order of the pushes."""


def push_force_n(cell: JudgedCell) -> float:
    """More than friction, and more than the slope of a chamfer, could resist with."""
    # How much a 45° chamfer with this friction holds against a push, as a multiple of what presses
    # on it: the tangent of 45° and the angle of friction together.
    slope = (1 + cell.friction) / (1 - cell.friction)
    return max(_LEAST_PUSH_N, 2 * _PRESS_N * slope) + 1.3 * cell.force_sigma_n


async def measure_capture(motions: ContactMotions, task: SearchTask) -> LateralCapture:
    """Push along x and back, along y and back, pressed lightly; the arm stays where it ends."""
    push_n = push_force_n(task.cell)
    # Where nothing carries the peg it is not at its seat, which its depth tells.
    begun = (await motions.press(_PRESS_N, _SETTLE_S, LostSupport(_PRESS_N))).last
    speed_m_s = _push_speed_m_s(task, push_n)
    pushes: dict[Side, ContactMotion | None] = {}
    way_m = _way_between_walls_m(task, push_n)
    for side in SIDES:
        push = await motions.touch(
            _along(side), way_m, push_n, speed_m_s, NothingFelt(task, side[0])
        )
        if push.ended is Ended.CONDITION:
            if not await sensor_answers(motions, task, push.last, _PRESS_N):
                pushes[side] = push
                break
            left_m = way_m - _gone_m(push, side)
            rest = await motions.touch(_along(side), left_m, push_n, speed_m_s)
            push = ContactMotion(rest.ended, (*push.samples, *rest.samples))
        pushes[side] = push
    return capture_of(begun, pushes, task)


async def walls_answer(motions: ContactMotions, task: SearchTask) -> bool:
    """Whether the sensor feels the walls between which a peg is pushed to and fro along x.

    False also where they stand farther apart than drawn.
    """
    least_n = least_change_n(task.cell.force_sigma_n)
    push_n = max(_LEAST_PUSH_N, 2 * least_n)
    ends: dict[Side, ContactMotion | None] = {}
    for side in ((0, 1.0), (0, -1.0)):
        ends[side] = push = await motions.touch(
            _along(side),
            _way_between_walls_m(task, push_n),
            push_n,
            _push_speed_m_s(task, push_n),
            NothingFelt(task, side[0]),
        )
        if push.ended is not Ended.FORCE:
            return False
    return _force_change_n(ends, 0) > least_n


def _way_between_walls_m(task: SearchTask, push_n: float) -> float:
    # The second push begins at the first contact and so has to undo what yielded there.
    yields_m = SOFTEST * push_n / task.cell.stiffness_n_m
    return 2 * task.fit.clearance_m + 2 * yields_m + 2 * MARGIN_M


def _along(side: Side) -> Vector:
    axis, sign = side
    direction = np.zeros(3)
    direction[axis] = sign
    return direction


def _gone_m(push: ContactMotion, side: Side) -> float:
    way = push.last.task_position_tip_m - push.samples[0].task_position_tip_m
    return max(0.0, float(way @ _along(side)))


def _push_speed_m_s(task: SearchTask, push_n: float) -> float:
    """So slow that what the push grows by until the arm has answered stays far below the limit."""
    growth_n = _SPARE_SHARE * (task.limits.insertion_n - push_n)
    cell = task.cell
    return min(_FASTEST_M_S, touch_speed_m_s(cell.stiffness_n_m, cell.dead_time_s, growth_n))


def capture_of(
    begun: ContactSample, pushes: Mapping[Side, ContactMotion | None], task: JudgedTask
) -> LateralCapture:
    """What four pushes have met; None for a side to which the peg was not pushed.

    ``begun``: pressed, before the first of them.
    """
    made = {side: push for side, push in pushes.items() if push is not None}
    resisted = sum(push.ended is Ended.FORCE for push in made.values())
    # A side that gave way says enough, whatever the others would have said.
    known = len(made) == len(SIDES) or resisted < len(made)
    depths = [push.last.task_position_tip_m[2] for push in made.values()]
    begun_m = float(begun.task_position_tip_m[2])
    # Between two opposite pushes the force must change by both of them. A sensor that is dead shows
    # the same twice.
    changes_n = [_force_change_n(pushes, axis) for axis in (0, 1)]
    known_n = [change_n for change_n in changes_n if not isnan(change_n)]
    return LateralCapture(
        resisted=resisted if known else None,
        play_x_m=_play_m(pushes, 0, task.cell),
        play_y_m=_play_m(pushes, 1, task.cell),
        depth_change_m=max((abs(float(depth) - begun_m) for depth in depths), default=nan),
        force_change_sigmas=max(known_n, default=nan) / task.cell.force_sigma_n,
    )


def _force_change_n(pushes: Mapping[Side, ContactMotion | None], axis: int) -> float:
    first, second = pushes.get((axis, 1.0)), pushes.get((axis, -1.0))
    if first is None or second is None:
        return nan
    return float(abs(first.last.force_n[axis] - second.last.force_n[axis]))


def _play_m(
    pushes: Mapping[Side, ContactMotion | None], axis: int, cell: JudgedCell
) -> float | None:
    first, second = pushes.get((axis, 1.0)), pushes.get((axis, -1.0))
    if first is None or second is None:
        return None
    if not first.ended is second.ended is Ended.FORCE:
        return None
    apart = first.last.task_position_tip_m[axis] - second.last.task_position_tip_m[axis]
    # Each push ends beyond its wall by what arm and contact yield under it.
    yields_m = [
        yielded_m(push.samples, axis, sign, push_force_n(cell), cell.stiffness_n_m)
        for push, sign in ((first, 1.0), (second, -1.0))
    ]
    play_m = float(apart) - sum(yields_m)
    # Arms are at most as much stiffer across the hole as softer: what comes out below that, no
    # walls and no arm can make, so it is no measurement.
    return play_m if play_m > -(sum(yields_m) / SOFTEST + MARGIN_M) else None
