"""What ends a motion in contact."""

from collections.abc import Callable

import numpy as np

from cellctl.cell.contact_motion.motions import Condition, ContactSample, Ended, Vector
from cellctl.force.contact.streamed.path import PathFollower

End = Callable[[ContactSample], Ended | None]

SOFTEST = 2.0
"""Arm and contact may be this many times softer across the hole than along it, the direction in
which the stiffness of the cell is measured. Arms differ by direction; the bound keeps a part that
moves under a push from passing for a soft arm."""
_REPEATABLE_M = 0.1e-3
"""Accuracy of the travel that an arm reports: it may seem to go this far and not leave its
contact."""
_LEAST_CHANGE_N, _LEAST_SIGMAS = 1.0, 8.0
"""Least change of a force that means something: in N, for friction, and in standard deviations of
one reading. The difference of two readings scatters by √2 of one, and motions compare two at each
tick: with eight, more than five of the difference, chance has no part in it."""


def least_change_n(force_sigma_n: float) -> float:
    """Least change of a force that means something; a smaller one may be friction, or noise.

    ``force_sigma_n`` is the standard deviation of one reading.
    """
    return max(_LEAST_CHANGE_N, _LEAST_SIGMAS * force_sigma_n)


def first_of(*ends: End) -> End:
    """Several, asked in their order until one holds."""

    def end(sample: ContactSample) -> Ended | None:
        return next((ended for one in ends if (ended := one(sample)) is not None), None)

    return end


def arrived(path: PathFollower) -> End:
    """The motion ends at the last point of a path."""
    return lambda _sample: Ended.TRAVEL if path.arrived else None


def when(until: Condition | None) -> End:
    """The motion ends by the caller's own condition; without one it never does."""
    return lambda sample: Ended.CONDITION if until is not None and until(sample) else None


class SomethingMet:
    """Ends a motion through free space when the force on the peg, in any direction, exceeds a
    limit.

    A motion may begin in contact, for instance when it leaves a face. Then the force must fall
    below the limit within the distance by which arm and contact have yielded to it, and it may not
    grow meanwhile: a force that stays or grows belongs to something that the motion drives into.
    """

    def __init__(self, limit_n: float, stiffness_n_m: float) -> None:
        self._limit_n, self._stiffness_n_m = limit_n, stiffness_n_m
        self._begin: ContactSample | None = None
        """The first sample with a force above the limit, if the motion began in contact."""
        self._left = False
        """True once the force has been below the limit: any force above it is a new contact
        then."""

    def __call__(self, sample: ContactSample) -> Ended | None:
        """``FORCE`` once something is met."""
        force_n = _size(sample.force_n)
        if force_n <= self._limit_n:
            self._left = True
            return None
        if self._left:
            return Ended.FORCE
        if self._begin is None:
            self._begin = sample
        begun_n = _size(self._begin.force_n)
        way_m = _size(sample.task_position_tip_m - self._begin.task_position_tip_m)
        stays = way_m > SOFTEST * begun_n / self._stiffness_n_m + _REPEATABLE_M
        grows = force_n - begun_n > least_change_n(sample.force_sigma_n)
        return Ended.FORCE if stays or grows else None


def _size(vector: Vector) -> float:
    return float(np.linalg.norm(vector))
