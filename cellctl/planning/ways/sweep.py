"""How near an arm comes to anything on a way, without a gap between the places that are looked at.

Conservative advancement (Mirtich, thesis, Berkeley 1996): with so much slack at one place, no body
can touch anything before the arm has gone that far.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.planning.scene.nearest import NarrowestGap
from cellctl.planning.scene.surroundings import Surroundings

STEP_M = 0.001
"""Where there is no slack left: no body moves further between two looks."""


@dataclass(frozen=True, slots=True, eq=False)
class SweptGap:
    """The narrowest gap that was seen on a way."""

    gap: NarrowestGap
    joints_rad: Array
    """Where, shape (6,)."""


def sweep(around: Surroundings, joints_rad: Array, extra_m: float = 0.0) -> SweptGap:
    """The narrowest gap on straight lines through joints of shape (n, 6).

    Ends at the first place with less slack than ``extra_m``. A way that is free keeps its slack at
    every place: what is seen there may be more than the least by no more than half.
    """
    worst: SweptGap | None = None
    for start_rad, end_rad in pairwise(joints_rad):
        worst = _sweep_line(around, start_rad, end_rad, extra_m, worst)
        if worst.gap.slack_m < extra_m:
            break
    if worst is None:
        raise ValueError("a way has two ends")
    return worst


def _sweep_line(
    around: Surroundings,
    start_rad: Array,
    end_rad: Array,
    extra_m: float,
    worst: SweptGap | None,
) -> SweptGap:
    # No point of the arm goes further than this on the whole line.
    way_m = float(np.abs(end_rad - start_rad) @ around.lever_m)
    share = 0.0
    while True:
        at_rad = start_rad + share * (end_rad - start_rad)
        gap = around.narrowest(at_rad)
        if worst is None or gap.slack_m < worst.gap.slack_m:
            worst = SweptGap(gap, at_rad)
        if gap.slack_m < extra_m or share >= 1.0:
            return worst
        # Half of the slack, so that the narrowest place is not passed by.
        step_m = max((gap.slack_m - extra_m) / 2, STEP_M)
        share = min(1.0, share + step_m / way_m) if way_m > 0.0 else 1.0
