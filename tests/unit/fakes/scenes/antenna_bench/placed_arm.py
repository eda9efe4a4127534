"""Benches whose arm stands at a taught pose from the beginning: driving there takes long."""

from typing import Any

import numpy as np

from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench
from fakes.world.arm import inverse
from fakes.world.frames import from_written


def bench_at(scenario: BenchScenario, pose: str, seed: int = 1, **sections: Any) -> AntennaBench:
    """The bench with its arm at a taught pose; ``sections`` replace those of the scenario."""
    return bench_with(scenario, scenario.taught["arm"][pose], seed, **sections)


def bench_with(
    scenario: BenchScenario, flange: tuple[float, ...], seed: int = 1, **sections: Any
) -> AntennaBench:
    """The same with the flange at a written pose."""
    arm = scenario.robots["arm"]
    home = np.deg2rad(arm.home_deg)
    joints = np.rad2deg(inverse(arm.chain_mm, from_written(flange), home)).tolist()
    robots = {"arm": arm.model_copy(update={"home_deg": tuple(joints)})}
    return AntennaBench(scenario.model_copy(update={"robots": robots, **sections}), seed)
