"""How deep a tilted peg dips into a hole, by where its bottom centre stands.

A peg that is tilted towards a direction touches a plate with the lowest point of its rim. Where
that point is over the hole the peg sinks until two other points of its rim rest on the edge. Seen
from above this makes a valley that leads to the hole from behind, and ends there at a wall.
Source: section 3.1 of the study of insertion by touch, compared there with a physical simulation.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FALLEN_IN_DIPS = 2.0
"""A peg over the hole falls in; how far is not decided by the map."""


def tilted_dip_m(
    hole_position_tip_m: Array,
    direction: Array,
    radius_m: float,
    clearance_m: float,
    tilt_rad: float,
) -> Array:
    """Depth below that of a touch beside the hole, shape (...) for positions (..., 2).

    ``direction`` is the unit vector (2,) towards which the peg leans, so that this side is lowest.
    """
    along = hole_position_tip_m @ direction
    across = hole_position_tip_m @ np.array([-direction[1], direction[0]])
    distance = np.hypot(along, across)
    ratio = np.minimum(distance / (2 * radius_m), 1.0)
    angle = np.arctan2(np.abs(across), -along) + np.arcsin(ratio)
    full_m = radius_m * tilt_rad
    dip = np.where(angle < np.pi / 2, full_m * (1 - np.sin(np.minimum(angle, np.pi / 2))), 0.0)
    dip = np.where(distance > 2 * radius_m, 0.0, dip)
    return np.where(distance < clearance_m, FALLEN_IN_DIPS * full_m, dip)


def leaning(direction: Array, tilt_rad: float) -> Array:
    """Rotation vector (3,) in frame A that lowers the side towards ``direction`` (2,)."""
    return tilt_rad * np.array([direction[1], -direction[0], 0.0])
