"""R9 of the study: the fits find what a simulated arm and contact truly have."""

import numpy as np
import pytest

from cellctl.errors.streamed_contact import LoopFitRefused
from cellctl.force.contact.streamed.gains import LoopFigures, damping, levers
from cellctl.force.contact.streamed.identification import (
    burst_dead_times,
    check_loop,
    check_step,
    chirp,
    fit_delay,
    fit_loop,
    fit_stiffness,
)
from cellctl.geometry.pose import Array
from tests.unit.force.contact.streamed.loops import SampledLoop

ALONG_Z = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


def ticking(count: int, period_s: float) -> Array:
    return np.asarray(np.arange(count) * period_s, dtype=np.float64)


def followed(
    command: Array, period_s: float, delay_ticks: int, lag_s: float
) -> tuple[Array, Array, Array]:
    """When each command was sent, when it was answered, and by what."""
    sent_s = ticking(len(command), period_s)
    response, at, steps = [], 0.0, 20
    late = np.concatenate([np.zeros(delay_ticks), command])[: len(command)]
    for target in late:
        for _ in range(steps):
            at += (1 - np.exp(-period_s / steps / lag_s)) * (target - at)
        response.append(at)
    return sent_s, np.asarray(sent_s + period_s), np.array(response, dtype=np.float64)


@pytest.mark.parametrize(
    ("period_s", "delay_ticks", "lag_s"),
    [(1e-3, 2, 2e-3), (4e-3, 2, 4e-3), (4e-3, 5, 8e-3), (8e-3, 3, 14e-3), (12e-3, 2, 8e-3)],
)
def test_a_chirp_shows_the_dead_time(period_s: float, delay_ticks: int, lag_s: float) -> None:
    rng = np.random.default_rng(4)
    command = 10.0 * chirp(1.0, 4.0, period_s)
    sent_s, read_s, response = followed(command, period_s, delay_ticks, lag_s)
    noisy = response + rng.normal(0.0, 0.3, len(response))
    true_s = delay_ticks * period_s + lag_s
    fit = fit_delay(sent_s, command, read_s, noisy)
    assert fit.dead_time_s + 1.5 * period_s == pytest.approx(true_s + 1.5 * period_s, rel=0.05)
    bursts = burst_dead_times(sent_s, command, read_s, noisy)
    assert np.median(bursts) + 1.5 * period_s == pytest.approx(true_s + 1.5 * period_s, rel=0.1)


def test_a_response_that_is_not_the_command_is_refused() -> None:
    command = chirp(1.0, 2.0, 4e-3)
    sent_s = ticking(len(command), 4e-3)
    noise = np.random.default_rng(1).normal(0.0, 1.0, len(command))
    with pytest.raises(LoopFitRefused, match=r"F579.*off a delayed command"):
        fit_delay(sent_s, command, sent_s + 4e-3, noise)


@pytest.mark.parametrize("stiffness_n_m", [1e5, 1e6, 1e7])
def test_readings_at_standstill_show_the_stiffness(stiffness_n_m: float) -> None:
    rng = np.random.default_rng(2)
    force_n = np.array([5.0, 10.0, 15.0, 20.0, 15.0, 10.0, 5.0])
    travel_m = force_n / stiffness_n_m + rng.normal(0.0, 0.05e-6, 7)
    fit = fit_stiffness(travel_m, force_n + rng.normal(0.0, 0.05, 7))
    assert fit.stiffness_n_m == pytest.approx(stiffness_n_m, rel=0.1)
    assert abs(fit.stiffness_n_m - stiffness_n_m) < 4 * fit.sigma_n_m + 0.01 * stiffness_n_m


def test_travel_that_does_not_follow_force_is_refused() -> None:
    with pytest.raises(LoopFitRefused, match="per newton"):
        fit_stiffness(np.array([0.0, 5e-6, 1e-6, 4e-6]), np.array([5.0, 10.0, 15.0, 20.0]))
    with pytest.raises(LoopFitRefused, match="four are needed"):
        fit_stiffness(np.zeros(2), np.array([5.0, 10.0]))


def stepped(stiffness_n_m: float, delay_ticks: int, ratio: float) -> tuple[SampledLoop, Array]:
    loop = SampledLoop(stiffness_n_m, ALONG_Z, np.ones(6), delay_ticks=delay_ticks)
    figures = LoopFigures(stiffness_n_m, loop.dead_time_s)
    loop.damping = damping(figures, levers(1.0), 1) * ratio / 1.5
    return loop, loop.force_n(5.0, round(12 * loop.dead_time_s / loop.period_s))


@pytest.mark.parametrize("stiffness_n_m", [1e5, 1e6, 1e7])
@pytest.mark.parametrize("delay_ticks", [1, 4, 9])
def test_a_closed_loop_shows_the_same_figures(stiffness_n_m: float, delay_ticks: int) -> None:
    loop, force_n = stepped(stiffness_n_m, delay_ticks, 3.0)
    time_s = ticking(len(force_n), loop.period_s)
    fitted = fit_loop(time_s, np.full(len(force_n), 5.0), force_n, float(loop.damping[2]))
    calculated = LoopFigures(stiffness_n_m, loop.dead_time_s)
    check_loop(calculated, fitted)
    assert fitted.stiffness_n_m == pytest.approx(stiffness_n_m, rel=0.1)


@pytest.mark.parametrize("ratio", [0.6, 1.5])
def test_figures_that_are_off_are_refused(ratio: float) -> None:
    with pytest.raises(LoopFitRefused, match=r"k theta = .*calculated were"):
        check_loop(LoopFigures(1e6, 24e-3), LoopFigures(ratio * 1e6, 24e-3))


def test_a_step_at_designed_gains_passes_and_one_at_half_of_them_does_not() -> None:
    loop, force_n = stepped(1e6, 3, 1.5)
    time_s = ticking(len(force_n), loop.period_s)
    check_step(time_s, force_n, 5.0, loop.dead_time_s)
    loop, force_n = stepped(1e6, 3, 0.75)
    with pytest.raises(LoopFitRefused, match="overshoots by"):
        check_step(time_s, force_n, 5.0, loop.dead_time_s)
    loop, force_n = stepped(1e6, 3, 8.0)
    with pytest.raises(LoopFitRefused, match="settles in"):
        check_step(time_s, force_n, 5.0, loop.dead_time_s)
