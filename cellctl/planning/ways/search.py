"""Searches a free way between two places: random trees, then short, plain and quick."""

import numpy as np
from ompl import base, geometric, util

from cellctl.errors.config import NoFreeWay
from cellctl.geometry.pose import Array
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.free import RESERVE_M, is_free_way
from cellctl.planning.ways.quicken import quickened
from cellctl.planning.ways.simplify import plain, rounded, shortened
from cellctl.planning.ways.travel import travel_s

_STEP_SHARE = 0.01
"""Distance between two looks of the search, as a share of the whole space of joints; the result is
then swept without a gap."""


def free_way(
    around: Surroundings,
    start_rad: Array,
    end_rad: Array,
    *,
    seed: int,
    search_s: float,
    tries: int = 3,
) -> Array:
    """Joints of shape (n, 6), both ends included, straight between which everything is free.

    RRT-Connect (Kuffner and LaValle, ICRA 2000), the quickest of a few tries. A seed gives the same
    way again unless the time is up. Raises ``NoFreeWay``.
    """
    # The straight line first: where it is free, any other way would be longer.
    direct = np.vstack([start_rad, end_rad])
    if is_free_way(around, direct):
        return direct
    found = []
    for number in range(tries):
        # From 1 on: OMPL does not accept 0 for a seed.
        rough = _tree(around, start_rad, end_rad, seed * tries + number + 1, search_s / tries)
        if rough is not None:
            short = shortened(around, rough, np.random.default_rng([seed, number]))
            # The tree looks at places: a line of it that nothing has replaced was not swept yet.
            if is_free_way(around, short):
                found.append(short)
    if not found:
        raise NoFreeWay(
            f"none within {search_s:g} s; the nearest at its start: {around.narrowest(start_rad)}; "
            f"at its end: {around.narrowest(end_rad)}"
        )
    quickest = min(found, key=lambda way: travel_s(around.arm, way))
    quick = quickened(around, plain(around, quickest), np.random.default_rng([seed, tries]))
    return rounded(around, plain(around, quick))


def _tree(
    around: Surroundings, start_rad: Array, end_rad: Array, seed: int, search_s: float
) -> Array | None:
    util.noOutputHandler()
    # OMPL has one generator for the whole process; without a seed of ours two runs would plan two
    # ways.
    util.RNG.setSeed(seed)
    space = base.RealVectorStateSpace(6)
    bounds = base.RealVectorBounds(6)
    for joint, (low, high) in enumerate(
        zip(around.arm.chain.lower_rad, around.arm.chain.upper_rad, strict=True)
    ):
        bounds.setLow(joint, float(low))
        bounds.setHigh(joint, float(high))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)

    def free(state: object) -> bool:
        joints_rad = np.array([state[joint] for joint in range(6)])  # type: ignore[index]
        in_bounds = around.refusal(joints_rad) is None
        return in_bounds and around.has_room(joints_rad, RESERVE_M)

    setup.setStateValidityChecker(free)
    setup.getSpaceInformation().setStateValidityCheckingResolution(_STEP_SHARE)
    setup.setStartAndGoalStates(_state(space, start_rad), _state(space, end_rad))
    setup.setPlanner(geometric.RRTConnect(setup.getSpaceInformation()))
    setup.solve(search_s)
    # Out of time OMPL also gives a way that only comes near the goal.
    if not setup.haveExactSolutionPath():
        return None
    states = setup.getSolutionPath().getStates()
    return np.array([[state[joint] for joint in range(6)] for state in states])


def _state(space: base.RealVectorStateSpace, joints_rad: Array) -> object:
    state = space.allocState()
    for joint, value in enumerate(joints_rad):
        state[joint] = float(value)
    return state
