"""The commissioning procedures on the fake cell's world, on simulated time."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.force import CommissioningFailed, NotSettled
from cellctl.errors.robot import SpeedOverridden
from cellctl.interfaces import RobotState
from cellctl.procedures.payload import STEADY_N, still_wrench
from cellctl.procedures.stop_latency import at_rest, measure_stop_latency, stored_stop_latencies
from cellctl.procedures.stop_latency_result import StopLatency
from cellctl.runtime.steps import HeldMeanwhile
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.simulated_loop import run_simulated

UP = np.array([0.0, 0.0, 1.0])
SAME_STOPS = {"latency_jitter": 0.0, "stop_jitter": 0.0}
"""Every stop takes the time that the test has chosen."""
LINEAR_SENSOR = {"sensor_nonlinearity": 0.0, "sensor_hysteresis": 0.0}
"""Its matrix says all about it."""


async def go_on(_number: int, _total: int) -> None:
    """No Hold is pending."""


def measured(latency_s: float) -> tuple[MatingCell, StopLatency]:
    cell = MatingCell.drawn(
        1, stiffness_n_m=1e6, stop_latency_s=latency_s, imperfections=SAME_STOPS
    )

    async def run() -> StopLatency:
        return await measure_stop_latency(
            cell.robot, UP, go_on, speeds_m_s=(3e-3, 5e-3, 8e-3), repeats=2
        )

    result = run_simulated(cell.start_s, cell.advance, run)
    assert isinstance(result, StopLatency)
    return cell, result


@pytest.mark.parametrize("latency_s", [pytest.param(0.05, marks=pytest.mark.long), 0.25])
def test_the_latency_of_the_fake_is_found(latency_s: float) -> None:
    cell, found = measured(latency_s)
    braking_s = 2.0 * np.mean(found.speeds_m_s) / 2.0 / 0.5
    assert found.estimate.latency_s == pytest.approx(latency_s + braking_s, abs=0.006)
    assert found.estimate.upper_s > latency_s
    assert not cell.controller.latched, "left ready to move"


def test_a_robot_that_overhears_the_stop_is_no_latency() -> None:
    cell = MatingCell.drawn(1, stiffness_n_m=1e6, stop_latency_s=0.05)
    before_m = cell.robot.reported.translation

    async def run() -> None:
        cell.faults.inject("ignore_stop", count=None)
        await measure_stop_latency(cell.robot, UP, go_on, speeds_m_s=(8e-3,), repeats=1)

    with pytest.raises(Exception, match="F304"):
        run_simulated(cell.start_s, cell.advance, run)
    assert cell.robot.reported.translation[2] - before_m[2] < 0.031


def test_too_few_speeds_are_refused() -> None:
    cell = MatingCell.drawn(1, stiffness_n_m=1e6, stop_latency_s=0.05)

    async def run() -> StopLatency:
        return await measure_stop_latency(cell.robot, UP, go_on, speeds_m_s=(8e-3,), repeats=1)

    with pytest.raises(CommissioningFailed, match="three or more"):
        run_simulated(cell.start_s, cell.advance, run)


def test_a_robot_that_is_slowed_down_at_its_panel_measures_nothing() -> None:
    cell = MatingCell.drawn(1, stiffness_n_m=1e6, stop_latency_s=0.05)
    before_m, full = cell.robot.reported.translation, cell.robot.state

    def slowed(max_age_s: float = 0.25) -> RobotState:
        return replace(full(max_age_s), speed_override_ratio=0.5)

    cell.robot.state = slowed  # type: ignore[method-assign]

    async def run() -> StopLatency:
        return await measure_stop_latency(cell.robot, UP, go_on)

    with pytest.raises(SpeedOverridden, match="50 %"):
        run_simulated(cell.start_s, cell.advance, run)
    np.testing.assert_allclose(cell.robot.reported.translation, before_m, atol=1e-4)


@pytest.mark.figures  # six stops more
def test_a_hold_is_obeyed_before_each_stop() -> None:
    cell = MatingCell.drawn(1, stiffness_n_m=1e6, stop_latency_s=0.05)
    asked: list[tuple[int, int]] = []

    async def held_at_the_second(number: int, total: int) -> None:
        asked.append((number, total))
        if number == 2:
            raise HeldMeanwhile

    async def run() -> StopLatency:
        return await measure_stop_latency(
            cell.robot, UP, held_at_the_second, speeds_m_s=(5e-3, 8e-3), repeats=1
        )

    with pytest.raises(HeldMeanwhile):
        run_simulated(cell.start_s, cell.advance, run)
    assert asked == [(1, 2), (2, 2)]


def test_a_still_wrench_is_the_mean_of_steady_readings() -> None:
    cell = MatingCell.drawn(2, stiffness_n_m=1e6, stop_latency_s=0.05, imperfections=LINEAR_SENSOR)

    async def run(steady_n: float = STEADY_N) -> tuple[object, np.ndarray]:
        sensor_frame = cell.flange_T_sensor
        return await still_wrench(cell.robot, cell.guard, sensor_frame, steady_n=steady_n)

    _, wrench = run_simulated(cell.start_s, cell.advance, run)
    sensor = cell.world.truth.force_sensors["force"]
    load = np.linalg.solve(sensor.matrix, wrench - sensor.offset)
    assert np.linalg.norm(load[:3]) == pytest.approx(200.0 * 9.80665, rel=0.002)
    cell = MatingCell.drawn(2, stiffness_n_m=1e6, stop_latency_s=0.05)
    with pytest.raises(NotSettled, match="scatter"):
        run_simulated(cell.start_s, cell.advance, partial(run, steady_n=0.1))


def test_stored_results_are_told_from_other_calibrations(tmp_path: Path) -> None:
    shipped = Path("config/demo-calibration")
    (stored,) = stored_stop_latencies(shipped)
    assert stored.kind == "stop_latency"
    assert stored.upper_ms > 100.0
    assert stored_stop_latencies(tmp_path) == ()
    # A file that somebody has changed is none.
    text = (shipped / "stop_latency.json").read_text()
    (tmp_path / "stop_latency.json").write_text(text.replace('"upper_ms": ', '"upper_ms": 1'))
    assert stored_stop_latencies(tmp_path) == ()
    (tmp_path / "stop_latency.json").write_text(text)
    assert stored_stop_latencies(tmp_path) == (stored,)


def test_an_arm_that_never_comes_to_rest_is_a_fault() -> None:
    cell = MatingCell.drawn(1, stiffness_n_m=1e6, stop_latency_s=0.05)
    state = cell.robot.state

    def moving(max_age_s: float = 0.25) -> RobotState:
        return replace(state(max_age_s), moving=True)

    cell.robot.state = moving  # type: ignore[method-assign]

    async def run() -> None:
        with pytest.raises(CommissioningFailed, match="still moves after 1 s"):
            await at_rest(cell.robot, timeout_s=1.0)

    run_simulated(cell.start_s, cell.advance, run)
