"""Moves the points of a free way to where the arm takes less time.

A tree leads around an obstacle somewhere, and corners that are cut end where the tree has been; how
far aside a point has to stand is for this search.
"""

from itertools import pairwise

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.free import WAY_RESERVE_M, is_free_with_reserve
from cellctl.planning.ways.travel import travel_s

_TRIES = 400
"""Random changes of a way that are tried."""
_FIRST_RAD = np.radians(40.0)
_LAST_RAD = np.radians(1.0)
"""Standard deviation of a step of a joint, at the first and at the last try."""
_MERGED_SHARE = 0.3
"""Share of the tries that put one point in place of two neighbours."""
_WORTH_S = 0.02
"""A gain below that is not worth to sweep the way for it."""
_LOOKS = 8
"""Places of each stretch at which a change is looked at before the whole way is swept."""


def quickened(around: Surroundings, way_rad: Array, rng: np.random.Generator) -> Array:
    """A way of as many points or fewer, never slower; joints of shape (n, 6), free like the first.

    Ever smaller random steps of one point at a time, of which those are kept that gain time: travel
    times have kinks, because the slowest joint counts, and no gradient leads along them.
    """
    time_s = travel_s(around.arm, way_rad)
    for sigma_rad in np.geomspace(_FIRST_RAD, _LAST_RAD, _TRIES):
        if len(way_rad) == 2:
            break
        changed, index = _step(around, way_rad, sigma_rad, rng)
        changed_s = travel_s(around.arm, changed)
        if changed_s < time_s - _WORTH_S and _lines_free(around, changed[index - 1 : index + 2]):
            way_rad, time_s = changed, changed_s
    return way_rad


def _step(
    around: Surroundings, way_rad: Array, sigma_rad: float, rng: np.random.Generator
) -> tuple[Array, int]:
    """The way with one point elsewhere, and the index of that point."""
    index = int(rng.integers(1, len(way_rad) - 1))
    changed = way_rad.copy()
    if index < len(way_rad) - 2 and rng.random() < _MERGED_SHARE:
        share = rng.random()
        changed = np.delete(changed, index + 1, axis=0)
        changed[index] = (1.0 - share) * way_rad[index] + share * way_rad[index + 1]
    # Some joints at a time: what the others have reached is not lost by it.
    moved = rng.random(6) < 0.5
    changed[index] += moved * rng.normal(0.0, sigma_rad, 6)
    chain = around.arm.chain
    changed[index] = np.clip(changed[index], chain.lower_rad, chain.upper_rad)
    return changed, index


def _lines_free(around: Surroundings, lines_rad: Array) -> bool:
    # Most steps lead into something: a few looks find that sooner than a sweep that begins at the
    # free end.
    looks = [np.linspace(a, b, _LOOKS) for a, b in pairwise(lines_rad)]
    rough = all(around.has_room(at_rad, WAY_RESERVE_M) for at_rad in np.vstack(looks))
    return rough and is_free_with_reserve(around, lines_rad)
