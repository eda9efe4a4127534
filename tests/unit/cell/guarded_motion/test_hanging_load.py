"""A zero that hides more than what hangs on the sensor is not taken: the section begins no move."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.cell.guarded_motion.free_moves import free_tolerance, guarded_section
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import TareImplausible
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.report import TareResult
from tests.unit.cell.bench import Bench, make_bench

WEIGHT_N = 200.0 * 9.80665
"""By the ``load`` of the shipped cell, with 12 kg of tolerance; its sensor reaches to 5 kN."""
DOUBT_N = 12.0 * 9.80665 + 100.0


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return make_bench(tmp_path)


async def section(bench: Bench, arm: GuardedRobot, untared: Sequence[float]) -> float:
    """The limit (N) on Fz inside a section that begins with this wrench in the sensor's axes."""
    guard = bench.cell.guard
    guard.gravity_compensated = False

    async def tare(_: float) -> TareResult:
        return TareResult(np.array(untared, dtype=float), np.ones(6), 100)

    guard.tare = tare  # type: ignore[assignment, method-assign]
    async with guarded_section(arm, free_tolerance(arm)):
        assert guard.armed
    return float(guard.limits[-1].filtered[2])


@pytest.mark.parametrize(
    "force_n",
    [(0, 0, -WEIGHT_N - DOUBT_N + 1), (0, 0, -1500), (0, 0, 0), (0, DOUBT_N - 1, -WEIGHT_N)],
    ids=["heaviest", "empty gripper", "nothing", "offset across"],
)
async def test_what_hangs_there_is_taken_as_zero(bench: Bench, force_n: Sequence[float]) -> None:
    arm = bench.deck.arm
    limit_n = await section(bench, arm, (*force_n, 0, 0, 0))
    assert limit_n == pytest.approx(arm.sensor.free_force_n + np.linalg.norm(force_n))


@pytest.mark.parametrize(
    ("untared", "words"),
    [
        ((0, 0, -WEIGHT_N - 1000, 0, 0, 0), "force downwards is 2961.3 N"),
        ((0, 0, DOUBT_N + 1, 0, 0, 0), "force upwards"),
        ((0, DOUBT_N + 1, -WEIGHT_N, 0, 0, 0), "force across gravity"),
        ((0, 0, -WEIGHT_N, 1200, 0, 0), "moment is 1200.0 N·m"),
        ((0, 0, np.nan, 0, 0, 0), "is nan"),
    ],
    ids=["drags", "is lifted", "leans", "is twisted", "not known"],
)
async def test_what_else_presses_is_no_zero(
    bench: Bench, untared: Sequence[float], words: str
) -> None:
    with pytest.raises(TareImplausible, match=words):
        await section(bench, bench.deck.arm, untared)
    guard = bench.cell.guard
    assert not guard.armed
    assert guard.limits == []


async def test_the_weight_is_looked_for_where_the_arm_has_its_down(bench: Bench) -> None:
    lying = pose_from_xyzabc([1500.0, 0.0, 1600.0, 0.0, 90.0, 0.0])
    bench.cell.main.flange = lying
    sensor_down = (lying * bench.deck.arm.flange_T_sensor).rotation.inv().apply([0.0, 0.0, -1.0])
    hanging = np.concatenate([WEIGHT_N * sensor_down, np.zeros(3)])
    await section(bench, bench.deck.arm, hanging.tolist())
    with pytest.raises(TareImplausible, match="across gravity"):
        await section(bench, bench.deck.arm, (0, 0, -WEIGHT_N, 0, 0, 0))


async def test_without_a_stated_load_the_weight_is_below_the_limit_of_free_moves(
    bench: Bench,
) -> None:
    stated = bench.deck.arm
    arm = replace(stated, config=stated.config.model_copy(update={"load": None}))
    most_n = stated.sensor.free_force_n
    assert await section(bench, arm, (0, most_n - 1, 0, 0, 0, 0)) < 2 * most_n
    with pytest.raises(TareImplausible, match=f"the force is {most_n + 1:.1f} N"):
        await section(bench, arm, (0, most_n + 1, 0, 0, 0, 0))


async def test_a_driver_that_names_no_range_leaves_the_offset_to_its_limits(bench: Bench) -> None:
    stated = bench.deck.arm
    settings = {key: value for key, value in stated.sensor.settings.items() if key != "range"}
    unnamed = stated.sensor.model_copy(update={"settings": settings})
    least_n = 12.0 * 9.80665 + 0.02 * unnamed.free_force_n
    with pytest.raises(TareImplausible, match=f"at most {least_n:.1f} N"):
        await section(bench, replace(stated, sensor=unnamed), (0, 0, least_n + 1, 0, 0, 0))
