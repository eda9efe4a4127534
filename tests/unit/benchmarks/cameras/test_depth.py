"""The discs of the benchmark of depths: truth without noise, and the depth's own share."""

import numpy as np
import pytest

from benchmarks.cameras.depth import rms_px
from benchmarks.cameras.disc_images import Light, Sensor, centre_px, drawn, eight_bit, exposed

GOOD = Light("good", 0.3, 0.85)


@pytest.mark.parametrize("light", [GOOD, Light("bright disc", 0.9, 0.1)])
def test_without_noise_the_centre_is_the_truth(light: Light) -> None:
    truth = np.array([21.3, 21.8])
    assert centre_px(drawn(truth, light), light) == pytest.approx(truth, abs=1e-5)


def test_noise_is_that_of_the_sensor() -> None:
    flat = np.full((200, 200), 0.5)
    sensor = Sensor("usual", 10_000.0, 0.0)
    counts = exposed(flat, sensor, np.random.default_rng(1)).astype(float)
    assert counts.mean() == pytest.approx(0.5 * 4095, rel=0.001)
    assert counts.std() == pytest.approx(np.sqrt(5000.0) / 10_000.0 * 4095, rel=0.02)


def test_eight_bit_are_the_upper_ones() -> None:
    assert eight_bit(np.array([[0, 15, 16, 4095]], dtype=np.uint16)).tolist() == [[0, 0, 1, 255]]


def test_depth_counts_where_there_is_no_other_noise() -> None:
    """With hardly any noise the steps of 8 bit are all that is left, and 12 bit must win."""
    found = rms_px(Sensor("ideal", 1e9, 0.0), Light("poor", 0.04, 0.08), 4, 2, seed=3)
    assert found["12 bit"] < 0.3 * found["8 bit"]
