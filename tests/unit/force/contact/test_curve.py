import numpy as np
import pytest

from cellctl.force.contact.curve import curve_statistics, moving_average


def test_figures_of_a_push() -> None:
    time_s = 100.0 + np.arange(3000, dtype=np.float64) * 1e-3
    wrench = np.zeros((3000, 6))
    wrench[:, 2] = np.clip((time_s - 101.0) * 40.0, 0.0, 38.0)
    wrench[1500, 2] = 60.0
    wrench[1200, 0], wrench[1200, 1] = 3.0, 4.0
    wrench[1300, 4] = -7.0
    found = curve_statistics(time_s, wrench)
    assert found.samples == 3000
    assert found.rate_hz == pytest.approx(1000.0)
    assert found.peak_fz_n == 60.0
    assert found.peak_filtered_fz_n < 45.0, "one sample is not a peak of the filtered force"
    assert found.peak_lateral_n == pytest.approx(5.0)
    assert found.peak_moment_n_m == pytest.approx(7.0)
    assert found.final[2] == pytest.approx(38.0)
    assert found.final_sigma[2] == pytest.approx(0.0, abs=1e-12)


def test_a_curve_needs_samples() -> None:
    with pytest.raises(ValueError, match="two samples"):
        curve_statistics(np.zeros(1), np.zeros((1, 6)))


def test_the_moving_average_starts_with_what_there_is() -> None:
    np.testing.assert_allclose(moving_average(np.array([2.0, 4.0, 6.0, 8.0]), 2), [2, 3, 5, 7])
