"""The streaming detectors against the same detectors on whole records."""

import numpy as np
import pytest

from cellctl.force import detectors as records
from cellctl.guard.detectors import Burst, Cusum, Frozen, LowPass, beyond
from cellctl.guard.limits import CusumTouch


def ramp(seed: int) -> list[float]:
    rng = np.random.default_rng(seed)
    return (rng.normal(0, 2.5, 600) + np.maximum(0, np.arange(600) - 300) * 0.3).tolist()


@pytest.mark.parametrize("seed", range(5))
def test_cusum_alarms_at_the_same_sample(seed: int) -> None:
    force = ramp(seed)
    streaming = Cusum(CusumTouch())
    alarms = [streaming.update(value) for value in force]
    assert alarms.index(True) == records.Cusum().first_alarm(np.array(force))


def test_low_pass_is_the_same_filter() -> None:
    signal = np.random.default_rng(3).normal(size=(200, 6))
    streaming = LowPass(5e-3)
    rows = [streaming.update(tuple(row), k * 1e-3) for k, row in enumerate(signal.tolist())]
    assert np.allclose(rows, records.low_pass(signal, 5e-3, 1e-3), atol=1e-12)


def test_low_pass_survives_time_that_stands_or_goes_back() -> None:
    streaming = LowPass(5e-3)
    streaming.update((0.0,) * 6, 1.0)
    assert streaming.update((1.0,) * 6, 1.0) == (0.0,) * 6
    assert streaming.update((1.0,) * 6, 0.5) == (0.0,) * 6
    assert 0.0 < streaming.update((1.0,) * 6, 0.505)[0] < 1.0


def test_beyond_names_the_first_component() -> None:
    assert beyond((0.0,) * 6, (1.0,) * 6) is None
    assert beyond((0.0, 0.0, -1.1, 0.0, 5.0, 0.0), (1.0,) * 6) == 2
    assert beyond((float("nan"), *(0.0,) * 5), (1.0,) * 6) == 0
    assert beyond((float("nan"), *(0.0,) * 5), (float("inf"),) * 6) == 0


def test_frozen_starts_again_after_a_change() -> None:
    frozen = Frozen(3)
    a, b = (1.0,) * 6, (1.0,) * 5 + (2.0,)
    assert [frozen.update(value) for value in (a, a, b, b, b)] == [False] * 4 + [True]


def test_burst_forgets_after_its_window() -> None:
    burst = Burst(3, 0.1, start=10)
    assert not burst.update(12, 0.0)
    assert not burst.update(13, 0.2)
    assert burst.update(15, 0.25)
