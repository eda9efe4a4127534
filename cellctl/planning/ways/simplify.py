"""Cuts a rough way short, down to few points and few joints that leave their straight course."""

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.free import is_free_way, is_free_with_reserve
from cellctl.planning.ways.travel import travel_s

_SHORTCUTS = 40
"""Random shortcuts that are tried."""


def shortened(around: Surroundings, rough_rad: Array, rng: np.random.Generator) -> Array:
    """Cuts corners between random places of the way, and leaves out points that are not needed."""
    way_rad = _pruned(around, rough_rad)
    for _ in range(_SHORTCUTS):
        if len(way_rad) == 2:
            break
        cut = _cut(way_rad, rng)
        quicker = travel_s(around.arm, cut) < travel_s(around.arm, way_rad)
        if quicker and is_free_with_reserve(around, cut):
            way_rad = cut
    return _pruned(around, way_rad)


def _cut(way_rad: Array, rng: np.random.Generator) -> Array:
    """The way with a straight line between two random places of it."""
    first, last = np.sort(rng.uniform(0.0, len(way_rad) - 1.0, 2))
    index, beyond = int(first), int(last) + 1
    return np.vstack(
        [way_rad[: index + 1], _between(way_rad, first), _between(way_rad, last), way_rad[beyond:]]
    )


def _between(way_rad: Array, place: float) -> Array:
    index = min(int(place), len(way_rad) - 2)
    share = place - index
    return np.asarray((1.0 - share) * way_rad[index] + share * way_rad[index + 1])


def _pruned(around: Surroundings, way_rad: Array) -> Array:
    """The way with as few points as possible: each leads straight to the farthest that is free."""
    kept, here = [way_rad[0]], 0
    while here < len(way_rad) - 1:
        ahead = len(way_rad) - 1
        while ahead > here + 1:
            if is_free_with_reserve(around, np.vstack([way_rad[here], way_rad[ahead]])):
                break
            ahead -= 1
        kept.append(way_rad[ahead])
        here = ahead
    return np.array(kept)


def plain(around: Surroundings, way_rad: Array) -> Array:
    """Joints that need not leave their straight course do not: a person can follow such a way.

    No joint is straightened where that makes the way slower.
    """
    shares = np.linspace(0.0, 1.0, len(way_rad))
    for joint in (3, 5, 0, 4, 1, 2):
        straight = way_rad.copy()
        straight[:, joint] = (1.0 - shares) * way_rad[0, joint] + shares * way_rad[-1, joint]
        slower = travel_s(around.arm, straight) > travel_s(around.arm, way_rad)
        if not slower and is_free_with_reserve(around, straight):
            way_rad = straight
    return _pruned(around, way_rad)


def rounded(around: Surroundings, way_rad: Array) -> Array:
    """Points at tenths of a degree, as the file has them, where that leaves the way free."""
    tenths = way_rad.copy()
    tenths[1:-1] = np.radians(np.round(np.degrees(way_rad[1:-1]), 1))
    return tenths if is_free_way(around, tenths) else way_rad
