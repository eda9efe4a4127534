"""What ends a press or a slide of a search: entry, a standstill, a wall, or a face that is lost."""

from collections.abc import Callable

import numpy as np

from cellctl.cell.contact_motion.motion_rules.ends import least_change_n
from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.first_contact.classify import (
    ContactClass,
    class_by_force,
    light_threshold_n,
)
from cellctl.processes.peg_in_hole.plan.parameters import DETECTION_S, STANDS_M
from cellctl.processes.peg_in_hole.plan.task import CellFigures

Stop = Callable[[ContactSample], bool]

_ENTERED_S = 0.1
_LOST_RATIO = 0.3


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
        self._least_n, self._stand_s = _LOST_RATIO * press_n, stand_s
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
        self._least_n = _LOST_RATIO * press_n
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
    """Holds once the face falls away before a slide no longer as steeply as before.

    It carries the peg with less than the press as long as the arm follows it downwards, and with
    more as soon as it rises: on a flank that is as steep as the one before with so much more that
    the end must not wait for that.
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

    A stiff arm that is pressed down a chamfer meets more and more of it from the side, up to one
    and a half times the press: it has to be let go before. What only guides a sinking peg is the
    wall of its bore.
    """
    friction_n, carried_n = light_threshold_n(cell, press_n), _LOST_RATIO * press_n

    def condition(sample: ContactSample) -> bool:
        across_n = float(np.hypot(*sample.force_n[:2]))
        on_face = class_by_force(sample.force_n, cell) is ContactClass.END_FACE
        carries = abs(sample.force_n[2]) > carried_n
        return bool(carries and across_n > friction_n and not on_face)

    return condition
