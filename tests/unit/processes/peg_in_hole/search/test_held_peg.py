"""A spiral of an upright peg that a tight mouth holds sideways."""

import asyncio
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.processes.peg_in_hole.plan.parameters import search_parameters
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap
from cellctl.processes.peg_in_hole.search.probe import TouchProbe
from tests.unit.cell.contact_motion.elastic_world import ElasticWorld, contact
from tests.unit.processes.peg_in_hole.tasks import pin

_CLEARANCE_M = 0.01e-3
_SOFT_N_M = 98e3


@dataclass(eq=False)
class HoldingFace:
    """A face with a bore; arm and face are one spring, at whose end is the peg."""

    bore_m: NDArray[np.float64]
    holds: float
    """Side force over press that moves the peg: friction, and edges of peg and bore that cross."""
    peg_m: NDArray[np.float64] = field(default_factory=lambda: np.zeros(2))

    def __call__(self, tip: NDArray[np.float64]) -> NDArray[np.float64]:
        """The wrench on the peg."""
        aside = self.peg_m - self.bore_m
        over = np.hypot(*aside) < _CLEARANCE_M and tip[2] > 0
        press_n = 0.0 if over else _SOFT_N_M * max(tip[2], 0.0)
        way_m = tip[:2] - self.peg_m
        held_m = self.holds * press_n / _SOFT_N_M
        self.peg_m = self.peg_m + way_m * (1 - min(1.0, held_m / max(np.hypot(*way_m), 1e-12)))
        if over:
            aside = self.peg_m - self.bore_m
            beyond = max(1.0, np.hypot(*aside) / (0.99 * _CLEARANCE_M))
            self.peg_m = self.bore_m + aside / beyond
        side_n = -_SOFT_N_M * (tip[:2] - self.peg_m)
        return np.array([*side_n, -press_n, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("holds", [0.2, 0.4])
def test_a_spiral_takes_the_peg_along_that_a_tight_mouth_holds(holds: float) -> None:
    # Pressed with 8 N the peg stays, and the arm only bends: by more than the clearance.
    face = HoldingFace(np.array([0.02e-3, -0.02e-3]), holds)
    world = ElasticWorld(
        face, period_s=8e-3, delay_ticks=1, lag_s=5e-3, sigma_n=0.1, tip=np.zeros(6)
    )
    theta_s = world.dead_time_s
    task = pin(1e3 * _CLEARANCE_M, stiffness_n_m=_SOFT_N_M, dead_time_s=theta_s)
    motions = contact(world, LoopFigures(_SOFT_N_M, theta_s))
    hole_map = HoleMap(2e-3, task.fit.catch_radius_m)
    # Held by each of the points of a turn, it would take minutes.
    deadline_s = world.now_s + 20.0
    probe = TouchProbe(motions, task, search_parameters(task), hole_map, deadline_s)
    assert asyncio.run(probe.spiral(np.zeros(2), 0.1e-3))
