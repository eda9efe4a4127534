"""Whether an arm may go straight from point to point of a way."""

from itertools import pairwise

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.sweep import sweep

RESERVE_M = 0.005
"""What the search keeps beyond the margins, so that points may be rounded and cut short."""
WAY_RESERVE_M = RESERVE_M / 2
"""What a way keeps: less than the tree has kept, or its own lines would not pass; more than
nothing, so that points may still be rounded."""


def is_free_way(around: Surroundings, way_rad: Array, extra_m: float = 0.0) -> bool:
    """Whether the arm may go straight through joints of shape (n, 6), swept without a gap."""
    return sweep(around, way_rad, extra_m).gap.slack_m >= extra_m and all(
        around.refusal(at_rad) is None for at_rad in _looks(way_rad)
    )


def is_free_with_reserve(around: Surroundings, way_rad: Array) -> bool:
    """As ``is_free_way``, for points that may still be rounded."""
    return is_free_way(around, way_rad, WAY_RESERVE_M)


def _looks(way_rad: Array) -> Array:
    # Whether driver and zones allow a place is yes or no, without a distance that one could advance
    # by; so it is asked at every degree, as drivers ask it for the way of a joint move.
    step_rad = np.radians(1.0)
    lines = [
        np.linspace(start, end, 2 + int(np.abs(end - start).max() / step_rad))
        for start, end in pairwise(way_rad)
    ]
    return np.vstack(lines)
