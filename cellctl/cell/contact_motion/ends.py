"""What ends a motion in contact."""

from collections.abc import Callable

import numpy as np

from cellctl.cell.contact_motion.motions import Condition, ContactSample, Ended
from cellctl.force.contact.streamed.path import PathFollower

End = Callable[[ContactSample], Ended | None]


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


def force_above(limit_n: float) -> End:
    """The motion ends when the force on the peg, in any direction, is greater than this."""

    def end(sample: ContactSample) -> Ended | None:
        return Ended.FORCE if float(np.linalg.norm(sample.force_n)) > limit_n else None

    return end
