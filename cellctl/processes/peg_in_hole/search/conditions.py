"""What ends a press or a slide of a search: entry, a standstill, a wall, or a face that is lost."""

from collections.abc import Callable

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import least_change_n
from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.force.contact.streamed.speeds import DETECTION_S, LOST_SHARE
from cellctl.processes.peg_in_hole.first_contact.classify import (
    ContactClass,
    class_by_force,
    light_threshold_n,
)
from cellctl.processes.peg_in_hole.plan.parameters import STANDS_M
from cellctl.processes.peg_in_hole.plan.task import CellFigures

Stop = Callable[[ContactSample], bool]

_ENTERED_S = 0.1
"""A peg has entered when it stays below the depth of entry for this time (section 2, S4, of the
study of insertion by touch)."""


def depth_m(sample: ContactSample) -> float:
    """Depth of the tip below the face."""
    return float(sample.task_position_tip_m[2])


def either(*stops: Stop) -> Stop:
    """Holds when one of them does; they are asked in their order until one does."""
    return lambda sample: any(stop(sample) for stop in stops)


def held(entry_depth_m: float) -> Stop:
    """Holds once the tip has been below a depth for a while."""
    since: list[float] = []

    def condition(sample: ContactSample) -> bool:
        if depth_m(sample) <= entry_depth_m:
            # One reading above that depth begins the time anew, so noise cannot add up to an entry.
            since.clear()
            return False
        since.append(sample.time_s)
        return sample.time_s - since[0] >= _ENTERED_S

    return condition


class Stands:
    """Holds once something has carried the peg for a while, and it has gone no deeper."""

    def __init__(self, press_n: float, stand_s: float) -> None:
        self._least_n, self._stand_s = LOST_SHARE * press_n, stand_s
        self._begin: ContactSample | None = None

    def __call__(self, sample: ContactSample) -> bool:
        """The condition of a press."""
        if abs(sample.force_n[2]) < self._least_n:
            self._begin = None
            return False
        if self._begin is None or depth_m(sample) - depth_m(self._begin) > STANDS_M:
            self._begin = sample
        return sample.time_s - self._begin.time_s >= self._stand_s


class LostSupport:
    """Holds when the force along z has been nearly gone for the time of detection.

    A stiff arm descends only slowly into the hole, so force tells much earlier than depth.
    """

    def __init__(self, press_n: float) -> None:
        self._least_n = LOST_SHARE * press_n
        self.begin: ContactSample | None = None

    def __call__(self, sample: ContactSample) -> bool:
        """The condition of a slide."""
        if abs(sample.force_n[2]) > self._least_n:
            self.begin = None
            return False
        if self.begin is None:
            self.begin = sample
        return sample.time_s - self.begin.time_s >= DETECTION_S


class Bottomed:
    """Holds once the face in front of a slide stops falling away: the bottom of a valley is
    reached.

    While the arm follows a falling face, the face carries less than the press; as soon as it rises,
    it carries more. On a flank as steep as the one before it would carry so much more that the
    slide has to end at the first rise of the force.
    """

    def __init__(self) -> None:
        self._least_n = np.inf

    def __call__(self, sample: ContactSample) -> bool:
        """The condition of a slide."""
        carried_n = abs(float(sample.force_n[2]))
        # A slide may begin with the force of a climb that has just ended.
        self._least_n = min(self._least_n, carried_n)
        return carried_n > self._least_n + least_change_n(sample.force_sigma_n)


def against_a_wall(press_n: float, cell: CellFigures) -> Stop:
    """Holds when what carries the peg pushes sideways harder than the friction of a face could.

    A stiff arm that presses down a chamfer is pushed sideways more and more, up to one and a half
    times the press, and has to be let go before. A peg with a side force that nothing carries from
    below is different: it sinks, guided by the wall of its bore.
    """
    friction_n, carried_n = light_threshold_n(cell, press_n), LOST_SHARE * press_n

    def condition(sample: ContactSample) -> bool:
        across_n = float(np.hypot(*sample.force_n[:2]))
        on_face = class_by_force(sample.force_n, cell) is ContactClass.END_FACE
        carries = abs(sample.force_n[2]) > carried_n
        return bool(carries and across_n > friction_n and not on_face)

    return condition
