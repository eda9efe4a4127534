"""How hard a straight move of the flange accelerates what hangs from it."""

import numpy as np
from scipy.spatial.transform import RigidTransform

SLOWEST_SHARE = 0.1
"""A move that turns the deck about the flange has no way of the flange at all. A controller times
it by its angle, and by its acceleration all the same."""


def flange_acceleration_m_s2(
    base_T_start: RigidTransform,
    base_T_target: RigidTransform,
    flange_T_deck: RigidTransform,
    acceleration_m_s2: float,
) -> float:
    """The acceleration with which no part of the load gets more than ``acceleration_m_s2``.

    A controller accelerates along the way of the flange. A correction that turns carries the deck,
    which hangs below the flange, farther in the same time: 0.06 mm where the flange goes 0.02 mm,
    with three times the acceleration, which alone makes a load of 200 kg swing with 30 N. The load
    lies between flange and deck, so no part of it goes farther than the farther of these two.
    """
    flange_way_m = _way_m(base_T_start, base_T_target)
    deck_way_m = _way_m(base_T_start * flange_T_deck, base_T_target * flange_T_deck)
    if deck_way_m <= flange_way_m:
        return acceleration_m_s2
    return acceleration_m_s2 * max(flange_way_m / deck_way_m, SLOWEST_SHARE)


def _way_m(start: RigidTransform, target: RigidTransform) -> float:
    return float(np.linalg.norm(target.translation - start.translation))
