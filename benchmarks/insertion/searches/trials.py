"""One search on the kinematic model, checked against the truth."""

import asyncio
from dataclasses import dataclass

import numpy as np

from cellctl.processes.peg_in_hole.faults import ByTouchError
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.find_hole import STRATEGIES
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.patent import PatentMidpoint
from cellctl.processes.peg_in_hole.search.probe import TouchProbe
from tests.rigs.insertion.kinematic import KinematicMotions
from tests.rigs.insertion.surface import Truth

LIMIT_S = 120.0
"""Time limit of the reference's table, for all strategies alike."""


@dataclass(frozen=True, slots=True)
class SearchTrialOutcome:
    """What came of one search."""

    found: bool
    """True where the tip truly stands over the hole."""
    false_entry: bool
    """The strategy says that the peg has entered, the truth says no."""
    time_s: float
    touches: int


def run_search(
    task: SearchTask, name: SearchName, seed: int, residual_tilt_rad: float = 5.2e-3
) -> SearchTrialOutcome:
    """The same seed gives all strategies the same hole."""
    truth = Truth.draw(task, np.random.default_rng(seed), residual_tilt_rad)
    motions = KinematicMotions(task, truth, np.random.default_rng([seed, 1]))
    probe = TouchProbe(
        motions,
        task,
        search_parameters(task),
        HoleMap(task.cell.uncertainty_m, task.fit.catch_radius_m),
        LIMIT_S,
    )
    strategy = STRATEGIES[name]
    if name is SearchName.PATENT_MIDPOINT:
        # The patent leaves the first direction free.
        free_rad = float(np.random.default_rng([seed, 2]).uniform(0, 2 * np.pi))
        strategy = PatentMidpoint(free_rad)
    try:
        entered = asyncio.run(strategy.find(probe))
    except ByTouchError:
        entered = False
    over = float(np.hypot(*motions.true_offset_m)) < task.fit.catch_radius_m
    return SearchTrialOutcome(
        entered and over, entered and not over, motions.time_s, motions.touches
    )
