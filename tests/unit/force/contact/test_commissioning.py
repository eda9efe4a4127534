import numpy as np
import pytest

from cellctl.errors.force import CommissioningFailed
from cellctl.force.contact.commissioning import estimate_stiffness, estimate_stop_latency

SPEEDS = np.repeat([2e-3, 4e-3, 6e-3, 8e-3], 3)


@pytest.mark.parametrize("latency_s", [0.01, 0.05, 0.25])
def test_the_latency_is_found_and_its_sigma_is_honest(latency_s: float) -> None:
    rng = np.random.default_rng(21)
    errors = []
    for _ in range(300):
        overruns = latency_s * SPEEDS + SPEEDS**2 / 1.0 + rng.normal(0.0, 1e-5, len(SPEEDS))
        found = estimate_stop_latency(SPEEDS, overruns)
        curvature = 2.0 * SPEEDS.mean() / 2.0  # slope of v²/2a over the speeds used
        errors.append((found.latency_s - latency_s - 2.0 * curvature) / found.sigma_s)
    assert abs(np.mean(errors)) < 0.3
    assert 0.8 < np.std(errors) < 1.4


@pytest.mark.parametrize(
    ("speeds", "overruns", "message"),
    [
        ([1e-3, 2e-3], [1e-4, 2e-4], "three or more"),
        ([1e-3, 1.1e-3, 1.2e-3], [1e-4, 1.1e-4, 1.2e-4], "differ by 30 %"),
        ([1e-3, 2e-3, 4e-3], [4e-4, 2e-4, 1e-4], "do not grow"),
        ([1e-3, 2e-3, 3e-3, 4e-3], [1e-4, 9e-4, 1e-4, 5e-4], "do not grow"),
    ],
)
def test_a_senseless_record_is_refused(
    speeds: list[float], overruns: list[float], message: str
) -> None:
    with pytest.raises(CommissioningFailed, match=message):
        estimate_stop_latency(np.array(speeds), np.array(overruns))


def test_stiffness_and_contact_from_a_loading_curve() -> None:
    rng = np.random.default_rng(22)
    travel = np.linspace(0.00998, 0.01006, 12)
    force = np.maximum(0.0, 6e5 * (travel - 0.010)) + rng.normal(0.0, 0.2, 12)
    found = estimate_stiffness(travel, force)
    assert found.stiffness_n_m == pytest.approx(6e5, rel=0.05)
    assert found.contact_m == pytest.approx(0.010, abs=1e-6)
    assert found.upper_n_m > found.stiffness_n_m


def test_too_few_readings_in_contact_are_refused() -> None:
    with pytest.raises(CommissioningFailed, match="three readings"):
        estimate_stiffness(np.array([0.0, 1e-5, 2e-5]), np.array([0.0, 1.0, 8.0]))
    with pytest.raises(CommissioningFailed, match="does not grow"):
        estimate_stiffness(np.array([0.0, 1e-5, 2e-5]), np.array([30.0, 20.0, 10.0]))
