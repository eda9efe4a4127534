import numpy as np
import pytest

from cellctl.force.detectors import Cusum, above, low_pass, touch_threshold_n
from cellctl.guard.detectors import Cusum as GuardCusum
from cellctl.guard.detectors import LowPass
from cellctl.guard.limits import CusumTouch

PERIOD_S = 1e-3


def noise(seconds: float, rng: np.random.Generator, period_s: float = PERIOD_S) -> np.ndarray:
    sigma_n = 2.5
    time_s = np.arange(0.0, seconds, period_s)
    vibration = 2.0 * np.sqrt(2.0) * np.sin(2.0 * np.pi * 12.0 * time_s + rng.uniform(0, 6))
    return np.asarray(rng.normal(0.0, sigma_n, len(time_s)) + vibration)


@pytest.mark.parametrize(
    ("rate_n_s", "mean_n", "worst_n"), [(100, 8, 10), (300, 12, 15), (1000, 19, 23), (3000, 31, 33)]
)
def test_cusum_alarms_at_the_forces_of_the_reference(
    rate_n_s: float, mean_n: float, worst_n: float
) -> None:
    """force.md 3.3: mean and p95 of the true force at the alarm on ramps."""
    rng = np.random.default_rng(3)
    cusum = Cusum()
    forces = []
    for _ in range(60):
        signal = noise(1.5, rng)
        ramp = np.maximum(np.arange(len(signal)) * PERIOD_S - 0.5, 0.0) * rate_n_s
        index = cusum.first_alarm(signal + ramp)
        assert index is not None
        forces.append(ramp[index])
    assert np.mean(forces) == pytest.approx(mean_n, rel=0.25)
    assert np.percentile(forces, 95) < 1.25 * worst_n
    assert cusum.force_at_alarm(rate_n_s, PERIOD_S) == pytest.approx(mean_n, rel=0.3)


def test_cusum_does_not_alarm_on_noise_alone() -> None:
    rng = np.random.default_rng(4)
    assert Cusum().first_alarm(noise(300.0, rng)) is None
    assert above(noise(300.0, rng), 8.0) is not None, "a plain threshold does"


@pytest.mark.parametrize("rate_hz", [100.0, 250.0, 500.0, 4000.0])
def test_nor_does_that_of_another_rate(rate_hz: float) -> None:
    cusum = Cusum(threshold_n=touch_threshold_n(rate_hz))
    assert cusum.first_alarm(noise(300.0, np.random.default_rng(8), 1.0 / rate_hz)) is None


def test_the_study_and_the_guard_decide_on_the_same_sample() -> None:
    rng = np.random.default_rng(5)
    signal = noise(2.0, rng) + np.maximum(np.arange(2000) - 900, 0) * 0.08
    streaming = GuardCusum(CusumTouch())
    first = next(index for index, force in enumerate(signal) if streaming.update(float(force)))
    assert Cusum().first_alarm(signal) == first


def test_the_filters_agree_with_the_guard() -> None:
    rng = np.random.default_rng(6)
    signal = noise(0.5, rng)
    guard = LowPass(5e-3)
    six = [
        guard.update((float(force),) * 6, index * PERIOD_S)[2] for index, force in enumerate(signal)
    ]
    np.testing.assert_allclose(low_pass(signal, 5e-3, PERIOD_S), six, atol=1e-9)
