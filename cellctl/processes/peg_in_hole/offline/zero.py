"""Whether a recorded curve shows that its sensor was tared.

With a zero that is off a part is pushed with another force than is shown. A force with the feed
tells of one sense alone (``insertion.with_feed``), and of the other nothing does: what is shown is
greater than what is felt, so that a part that hardly rests on its seat passes for one that is
pressed onto it.
"""

import numpy as np

from cellctl.force.contact.recorded_zero import FEWEST_FREE, zero_off
from cellctl.geometry.pose import MM, Array
from cellctl.processes.peg_in_hole.insertion.with_feed import LEAST_SIGN_N
from cellctl.processes.peg_in_hole.offline.columns import FORCES
from cellctl.processes.peg_in_hole.offline.curve import PegCurve

_ABOVE_M = 0.5e-3
"""Over the touched face; the tip of a part in free space is higher than its height is uncertain."""
_MOST_N = LEAST_SIGN_N / 2.0
"""Half of what may act with a feed. Means of the fake cells lie within 0.2 N."""


def not_tared(curve: PegCurve) -> str | None:
    """Says which force acts before the part has touched anything; None if none does."""
    columns = [(curve.columns.get(name, name), "N", _MOST_N) for name in FORCES]
    return zero_off(_free_n(curve), columns, f"higher than {_ABOVE_M / MM:g} mm over the face")


def unknown_zero(curve: PegCurve) -> str | None:
    """What is to be said of a curve in which nothing shows its zero."""
    if len(_free_n(curve)) >= FEWEST_FREE:
        return None
    return (
        f"Nothing was recorded higher than {_ABOVE_M / MM:g} mm over the face, where no force "
        "acts. So nothing shows that the forces were tared, and all of the verdict rests on it."
    )


def _free_n(curve: PegCurve) -> Array:
    """Forces before the tip first comes near the face, shape (n, 3)."""
    depth_m = np.array([sample.task_position_tip_m[2] for sample in curve.samples])
    near = np.flatnonzero(depth_m >= -_ABOVE_M)
    before = int(near[0]) if near.size else len(depth_m)
    return np.array([sample.force_n for sample in curve.samples[:before]]).reshape(-1, 3)
