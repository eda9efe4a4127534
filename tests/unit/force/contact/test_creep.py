import itertools
from dataclasses import replace

import numpy as np
import pytest

from cellctl.force.contact.creep import CreepLaw, after_step, begin, done, next_step

LAW = CreepLaw(
    reference_n=38.6,
    done_low_n=36.2,
    done_high_n=41.0,
    damping_n_s_m=5e4,
    mass_kg=20.0,
    period_s=0.6,
    stiffness_n_m=9.09e5,
    greatest_step_m=1e-4,
    smallest_step_m=1e-6,
    force_sigma_n=0.3,
    abort_n=43.0,
    step_sigma_m=3e-6,
)
ARM_SIGMA_M = 2e-6


class Spring:
    """An arm against a contact; each move ends with an error, each reading has noise."""

    def __init__(
        self, stiffness: float, rng: np.random.Generator, start_n: float, noisy: float = 1.0
    ) -> None:
        self.stiffness, self.rng, self.noisy = stiffness, rng, noisy
        self.force = self.peak = start_n
        self.travel = self.error = 0.0

    def drive(self, step_m: float) -> None:
        before_m = self.travel + self.error
        self.travel += step_m
        self.error = self.noisy * self.rng.normal(0.0, ARM_SIGMA_M)
        self.force += self.stiffness * (self.travel + self.error - before_m)
        self.peak = max(self.peak, self.force)

    def read(self) -> float:
        return self.force + self.noisy * self.rng.normal(0.0, 0.3)


def creep(spring: Spring, law: CreepLaw = LAW) -> tuple[int, list[float]]:
    state = begin(law, spring.read(), spring.travel)
    forces = [state.force_n]
    while not done(law, state):
        spring.drive(next_step(law, state))
        state = after_step(law, state, spring.read(), spring.travel)
        forces.append(state.force_n)
        assert state.steps <= 60
    return state.steps, forces


@pytest.mark.parametrize("stiffness", [9e4, 2.3e5, 5e5, 7.5e5, 9.09e5])
def test_it_converges_below_the_limit_for_every_stiffness(stiffness: float) -> None:
    rng = np.random.default_rng(11)
    runs = [Spring(stiffness, rng, rng.uniform(6.0, 30.0)) for _ in range(100)]
    steps = [creep(run)[0] for run in runs]
    finals, peaks = np.array([[run.force, run.peak] for run in runs]).T
    assert np.median(steps) <= 20
    assert max(steps) <= 35
    assert finals.min() > 35.0
    assert finals.max() < 45.0
    assert peaks.max() < 50.0
    assert np.percentile(peaks, 95) < 45.0


@pytest.mark.parametrize("stiffness", [9e4, 5e5, 9.09e5])
def test_without_noise_it_never_overshoots(stiffness: float) -> None:
    """The bound of the module: the error keeps its sign while k stays below k_hat + S/T."""
    spring = Spring(stiffness, np.random.default_rng(1), 8.0, noisy=0.0)
    _, forces = creep(spring)
    assert all(after > before for before, after in itertools.pairwise(forces))
    assert forces[-1] <= LAW.reference_n


def test_the_gain_of_a_step_is_the_implicit_one() -> None:
    law = replace(LAW, abort_n=1e6, greatest_step_m=1.0)
    state = begin(law, 8.6, 0.0)
    expected = 0.6 * 30.0 / (5e4 + 20.0 / 0.6 + 0.6 * 9.09e5)
    assert next_step(law, state) == pytest.approx(expected)


def test_explicit_euler_would_oscillate_where_this_does_not() -> None:
    law = replace(LAW, abort_n=1e6, greatest_step_m=1.0)
    explicit_gain = law.period_s * law.stiffness_n_m / law.damping_n_s_m
    assert explicit_gain > 2.0, "explicit Euler is unstable here"
    gain = next_step(law, begin(law, 0.0, 0.0)) * law.stiffness_n_m / law.reference_n
    assert 0.5 < gain < 1.0


def test_no_step_can_pass_the_abort_force_at_the_upper_bound() -> None:
    for force_n in np.linspace(0.0, 33.8, 30):
        step_m = next_step(LAW, begin(LAW, float(force_n), 0.0))
        assert force_n + LAW.stiffness_n_m * (step_m + 3.0 * LAW.step_sigma_m) <= 43.0 + 1e-9


def test_contact_that_stiffens_stays_below_the_limit() -> None:
    """First an edge, then the whole face: stiffness doubles at 25 N."""
    rng = np.random.default_rng(12)
    for _ in range(100):
        spring = Spring(4.5e5, rng, 10.0)
        state = begin(LAW, spring.read(), 0.0)
        while not done(LAW, state):
            spring.stiffness = 9e5 if spring.force > 25.0 else 4.5e5
            spring.drive(next_step(LAW, state))
            state = after_step(LAW, state, spring.read(), spring.travel)
            assert state.steps < 60
        assert spring.peak < 50.0


def test_too_much_force_is_relaxed() -> None:
    spring = Spring(5e5, np.random.default_rng(13), 43.0)
    creep(spring)
    assert 35.0 < spring.force < 42.5


def test_relaxing_uses_what_the_creep_has_shown() -> None:
    law = replace(LAW, reference_n=15.0, done_low_n=12.0, done_high_n=18.0)
    blind = next_step(law, begin(law, 39.0, 0.0))
    shown = next_step(law, begin(law, 39.0, 0.0, shown_n_m=3e5))
    assert shown < blind < 0.0
