"""Capability and control chart against exact values and against draws whose truth is known."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from scipy.stats import chi2

from cellctl.records.trend import Sample, trend
from cellctl.records.trend import _chi_square_shares as shares

START = datetime(2026, 1, 1, tzinfo=UTC)


def samples(
    values: list[float], lower: float | None = None, upper: float | None = None
) -> list[Sample]:
    return [
        Sample(number, START + timedelta(hours=number), value, lower, upper)
        for number, value in enumerate(values, 1)
    ]


def test_the_figures_by_hand() -> None:
    found = trend(samples([1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0], 0.0, 4.0))
    assert found.mean == 1.5
    assert found.sigma == pytest.approx(1 / 1.128)
    assert found.cp is not None
    assert found.cp.value == pytest.approx(4.0 / (6 / 1.128))
    assert found.cpk is not None
    assert found.cpk.value == pytest.approx(1.5 / (3 / 1.128))
    assert found.upper_control == pytest.approx(1.5 + 3 / 1.128)
    assert found.signals == ()


def test_one_limit_has_no_cp() -> None:
    found = trend(samples([1.0, 2.0] * 6, upper=4.0))
    assert found.cp is None
    assert found.cpk is not None
    assert trend(samples([1.0, 2.0] * 6)).cpk is None


def test_few_runs_have_no_capability() -> None:
    assert trend(samples([1.0, 2.0, 1.0], 0.0, 4.0)).cp is None
    with pytest.raises(ValueError, match="needs two"):
        trend(samples([1.0]))


@pytest.mark.parametrize("freedom", [6.0, 12.0, 31.0, 124.0])
def test_the_approximation_of_chi_square(freedom: float) -> None:
    exact = chi2(freedom).ppf([0.025, 0.975]) / freedom
    np.testing.assert_allclose(shares(freedom), exact, rtol=0.03)


def test_the_interval_of_cpk_holds_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(5)
    true_cpk, held = 1.33, 0
    for _ in range(600):
        values = rng.normal(0.0, 1.0, 50).tolist()
        index = trend(samples(values, -3 * true_cpk, 3 * true_cpk + 3.0)).cpk
        assert index is not None
        held += index.low < true_cpk < index.high
    assert 0.92 < held / 600 < 0.98


def test_a_process_at_rest_is_seldom_called_changed() -> None:
    rng = np.random.default_rng(6)
    runs = sum(bool(trend(samples(rng.normal(size=20).tolist())).signals) for _ in range(300))
    assert runs < 75


@pytest.mark.parametrize(
    ("values", "run", "rule"),
    [
        ([0.0, 0.1] * 10 + [3.0], 21, "sigma from the mean"),
        ([0.0, 0.1, 0.0, 0.1] * 3 + [0.4, 0.5] * 6, 20, "on one side"),
        ([0.0, 0.2] * 6 + [0.01, 0.05, 0.1, 0.15, 0.2, 0.25], 18, "rising"),
        ([0.2, 0.0] * 6 + [0.24, 0.2, 0.15, 0.1, 0.05, 0.01], 18, "falling"),
    ],
)
def test_a_change_is_found_where_it_is(values: list[float], run: int, rule: str) -> None:
    found = [signal for signal in trend(samples(values)).signals if rule in signal.rule]
    assert run in [signal.run for signal in found], found
