import numpy as np
import pytest

from cellctl.force.contact.touch_detector import Cusum, CusumDetector, touch_threshold_n

PERIOD_S = 1e-3


def first_alarm(settings: Cusum, force_n: np.ndarray) -> int | None:
    """Index of the sample at which the running detector alarms."""
    detector = CusumDetector(settings)
    return next((k for k, value in enumerate(force_n.tolist()) if detector.update(value)), None)


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
        index = first_alarm(cusum, signal + ramp)
        assert index is not None
        forces.append(ramp[index])
    assert np.mean(forces) == pytest.approx(mean_n, rel=0.25)
    assert np.percentile(forces, 95) < 1.25 * worst_n
    assert cusum.force_at_alarm(rate_n_s, PERIOD_S) == pytest.approx(mean_n, rel=0.3)


def test_cusum_does_not_alarm_on_noise_alone() -> None:
    rng = np.random.default_rng(4)
    assert first_alarm(Cusum(), noise(300.0, rng)) is None
    assert (noise(300.0, rng) > 8.0).any(), "a plain threshold does"


@pytest.mark.parametrize("rate_hz", [100.0, 250.0, 500.0, 4000.0])
def test_nor_does_that_of_another_rate(rate_hz: float) -> None:
    cusum = Cusum(threshold_n=touch_threshold_n(rate_hz))
    assert first_alarm(cusum, noise(300.0, np.random.default_rng(8), 1.0 / rate_hz)) is None


@pytest.mark.parametrize("seed", range(5))
def test_the_running_sum_is_the_textbook_statistic(seed: int) -> None:
    """The sum of the excess less its lowest value so far, computed on the whole record."""
    rng = np.random.default_rng(seed)
    signal = noise(2.0, rng) + np.maximum(np.arange(2000) - 900, 0) * 0.08
    total = np.cumsum(signal - Cusum().drift_n)
    statistic = total - np.minimum(np.minimum.accumulate(total), 0.0)
    assert first_alarm(Cusum(), signal) == np.argmax(statistic > Cusum().threshold_n)


def test_an_alarm_starts_a_new_sum() -> None:
    detector = CusumDetector(Cusum(drift_n=4.0, threshold_n=10.0))
    assert [detector.update(10.0) for _ in range(4)] == [False, True, False, True]
