import pytest

from benchmarks.insertion.wilson import wilson_bounds


def test_all_of_300_found_is_at_least_98_7_percent() -> None:
    low, high = wilson_bounds(300, 300)
    assert low == pytest.approx(0.987, abs=5e-4)
    assert high == 1


def test_none_of_1000_is_at_most_0_4_percent() -> None:
    low, high = wilson_bounds(0, 1000)
    assert low == pytest.approx(0, abs=1e-12)
    assert high == pytest.approx(0.0038, abs=2e-4)


def test_half_scatters_by_its_binomial_error() -> None:
    low, high = wilson_bounds(150, 300)
    assert (low, high) == pytest.approx((0.444, 0.556), abs=2e-3)
