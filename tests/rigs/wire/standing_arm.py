"""The arm at the far end of tests and benchmarks of robots, standing."""

import time
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.sections import Robot
from fakes.scenes.load import load
from fakes.world.robot import RobotArm
from fakes.world.truth import RobotTruth, draw
from tests.rigs.wire.scenarios import as_on_a_real_cell

SCENARIO = Path(__file__).parents[3] / "config" / "deck.scenario.toml"
READY_DEG = (0.0, -52.76637, 109.14017, 0.0, 33.6262, 90.0)
"""Deck above the station, away from limits and singularities."""
TURNED_DEG = (4.0, -52.76637, 109.14017, 12.0, 33.6262, 70.0)
"""The same, turned so that the matrix of the flange differs from its transpose."""


@cache
def _drawn() -> tuple[Robot, RobotTruth]:
    """Read and drawn once: neither changes, and there are many rigs."""
    scenario = as_on_a_real_cell(load(SCENARIO))
    return scenario.robots["main"], draw(scenario, seed=1).robots["main"]


def standing_arm(
    stands_deg: Sequence[float] = READY_DEG,
) -> tuple[RobotArm, Callable[[], float]]:
    """The arm and its clock."""
    arm = RobotArm(*_drawn(), seed=1)
    arm.start_joint(0.0, np.radians(stands_deg), 100.0)
    started_s = time.monotonic() - arm.standstill_s
    return arm, lambda: time.monotonic() - started_s


def _raised_to(z_m: float) -> RigidTransform:
    """Straight above or below where the arm stands with ``READY_DEG``."""
    arm, clock = standing_arm()
    stands = arm.encoder_pose(clock())
    return RigidTransform.from_translation([0.0, 0.0, z_m - stands.translation[2]]) * stands


LOW_ROOM_MM = (2500.0, 900.0, 1080.0)
"""Upper corner of a box that ends not far above the standing arm."""
CEILING = (_raised_to(1.0799), _raised_to(1.0801))
"""Just within and just beyond that box."""
RATED_RAD_S_OF_FIRST = float(np.radians(_drawn()[0].rated_deg_s[0]))
