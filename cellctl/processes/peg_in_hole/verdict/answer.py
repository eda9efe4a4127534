"""Whether the sensor answers while nothing is felt of a push to a side.

A sensor that stays at a value shows the same as a peg that slides freely, and the arm would press
with all that is left of the way of its push. So a push on which nothing is felt ends where walls as
drawn would have been met, and goes on only after a greater press along the axis was felt.
"""

from cellctl.cell.contact_motion.motion_rules.ends import SOFTEST, least_change_n
from cellctl.cell.contact_motion.motions import ContactMotions, ContactSample
from cellctl.processes.peg_in_hole.search.conditions import LostSupport, depth_m, either
from cellctl.processes.peg_in_hole.verdict.judged_task import JudgedTask

MARGIN_M = 0.1e-3
"""How much farther than drawn a wall may stand."""
_PRESS_MORE = 3.0
"""How much more the peg is pressed to see whether the sensor answers, in least changes of a force:
three times what has to be felt."""
_ANSWERS_S = 1.0
"""Longest time for the answer, and for the way back to the lighter press."""
_REPEATABLE_M = 20e-6
"""Repeatability of an arm (section 1 of the study of insertion by touch)."""


class NothingFelt:
    """Holds where a push has gone on for a way on which a wall as drawn would have been felt."""

    def __init__(self, task: JudgedTask, axis: int) -> None:
        self._axis, self._least_n = axis, least_change_n(task.cell.force_sigma_n)
        yields_m = SOFTEST * self._least_n / task.cell.stiffness_n_m
        self._most_m = 2 * task.fit.clearance_m + MARGIN_M + yields_m
        self._changed: ContactSample | None = None

    def __call__(self, sample: ContactSample) -> bool:
        """The condition of a push."""
        axis, changed = self._axis, self._changed
        if changed is None or abs(sample.force_n[axis] - changed.force_n[axis]) > self._least_n:
            self._changed = changed = sample
        way_m = sample.task_position_tip_m[axis] - changed.task_position_tip_m[axis]
        return bool(abs(way_m) > self._most_m)


async def sensor_answers(
    motions: ContactMotions, task: JudgedTask, standing: ContactSample, press_n: float
) -> bool:
    """Whether a greater press is felt by the sensor; the peg is pressed with ``press_n`` again.

    False for a peg that nothing carries, too.
    """
    least_n = least_change_n(task.cell.force_sigma_n)
    more_n = _PRESS_MORE * least_n
    sinks_m = SOFTEST * more_n / task.cell.stiffness_n_m + _REPEATABLE_M

    def felt(sample: ContactSample) -> bool:
        return bool(abs(sample.force_n[2] - standing.force_n[2]) > least_n)

    def sunk(sample: ContactSample) -> bool:
        # With a sensor that is dead the arm would press on for all of its time.
        return depth_m(sample) - depth_m(standing) > sinks_m

    pressed = await motions.press(press_n + more_n, _ANSWERS_S, either(felt, sunk))
    # The arm comes to rest after that, maybe with a little less.
    answers = any(map(felt, pressed.samples))
    await motions.press(press_n, _ANSWERS_S, LostSupport(press_n))
    return answers
