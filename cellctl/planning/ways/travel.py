"""How long an arm takes for a way of joint moves."""

from itertools import pairwise

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm

STOP_S = 0.8
"""What standing still at each end of a straight line costs: ramps, and the next command."""


def travel_s(arm: PlannedArm, way_rad: Array) -> float:
    """Time from the first to the last of joints of shape (n, 6), with a stop at each of them.

    At the speed that the cell file states for moves between taught poses.
    """
    speed_rad_s = arm.rated_rad_s * arm.config.speed_percent / 100
    lines = [np.abs(end - start) / speed_rad_s for start, end in pairwise(way_rad)]
    return float(sum(float(line.max()) + STOP_S for line in lines))
