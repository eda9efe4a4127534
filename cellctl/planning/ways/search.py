"""Searches a free way between two places: random trees, then as few points as will do."""

from itertools import pairwise

import numpy as np
from ompl import base, geometric, util

from cellctl.errors.config import NoFreeWay
from cellctl.geometry.pose import Array
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.sweep import sweep
from cellctl.planning.ways.travel import travel_s

RESERVE_M = 0.005
"""What the search keeps beyond the margins, so that points may be rounded and cut short."""
_STEP_SHARE = 0.01
"""Distance between two looks of the search, as a share of the whole space of joints; the result is
then swept without a gap."""
_SHORTCUTS = 40


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
            rng = np.random.default_rng([seed, number])
            way = _rounded(around, _plain(around, _shortened(around, rough, rng)))
            # The tree looks at places: a line of it that nothing has replaced was not swept yet.
            if is_free_way(around, way):
                found.append(way)
    if not found:
        raise NoFreeWay(
            f"none within {search_s:g} s; the nearest at its start: {around.narrowest(start_rad)}; "
            f"at its end: {around.narrowest(end_rad)}"
        )
    return min(found, key=lambda way: travel_s(around.arm, way))


def is_free_way(around: Surroundings, way_rad: Array, extra_m: float = 0.0) -> bool:
    """Whether the arm may go straight through joints of shape (n, 6), swept without a gap."""
    return sweep(around, way_rad, extra_m).gap.slack_m >= extra_m and all(
        around.refusal(at_rad) is None for at_rad in _looks(way_rad)
    )


def _looks(way_rad: Array) -> Array:
    # Whether driver and zones allow a place is yes or no, without a distance that one could advance
    # by; so it is asked at every degree, as drivers ask it for the way of a joint move.
    step_rad = np.radians(1.0)
    lines = [
        np.linspace(start, end, 2 + int(np.abs(end - start).max() / step_rad))
        for start, end in pairwise(way_rad)
    ]
    return np.vstack(lines)


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


def _shortened(around: Surroundings, rough_rad: Array, rng: np.random.Generator) -> Array:
    """Cuts corners between random places of the way, and leaves out points that are not needed."""
    way_rad = _pruned(around, rough_rad)
    for _ in range(_SHORTCUTS):
        if len(way_rad) == 2:
            break
        cut = _cut(way_rad, rng)
        if travel_s(around.arm, cut) < travel_s(around.arm, way_rad) and _lines_free(around, cut):
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


def _lines_free(around: Surroundings, way_rad: Array) -> bool:
    # Less than the tree has kept, or its own lines would not pass; more than nothing, so that
    # points may still be rounded.
    return is_free_way(around, way_rad, RESERVE_M / 2)


def _pruned(around: Surroundings, way_rad: Array) -> Array:
    """From each point straight to the farthest that is free from there."""
    kept, here = [way_rad[0]], 0
    while here < len(way_rad) - 1:
        ahead = len(way_rad) - 1
        while ahead > here + 1:
            if _lines_free(around, np.vstack([way_rad[here], way_rad[ahead]])):
                break
            ahead -= 1
        kept.append(way_rad[ahead])
        here = ahead
    return np.array(kept)


def _plain(around: Surroundings, way_rad: Array) -> Array:
    """Joints that need not leave their straight course do not: a person can follow such a way."""
    shares = np.linspace(0.0, 1.0, len(way_rad))
    for joint in (3, 5, 0, 4, 1, 2):
        plain = way_rad.copy()
        plain[:, joint] = (1.0 - shares) * way_rad[0, joint] + shares * way_rad[-1, joint]
        if _lines_free(around, plain):
            way_rad = plain
    return _pruned(around, way_rad)


def _rounded(around: Surroundings, way_rad: Array) -> Array:
    """Points at tenths of a degree, as the file has them, where that leaves the way free."""
    rounded = way_rad.copy()
    rounded[1:-1] = np.radians(np.round(np.degrees(way_rad[1:-1]), 1))
    return rounded if is_free_way(around, rounded) else way_rad
