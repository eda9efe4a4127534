"""The detectors on signals whose outcome is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from cellctl.guard.limits import CusumTouch, GuardLimits
from cellctl.guard.watch.detectors import (
    ArmedDetectors,
    BurstDetector,
    FrozenDetector,
    LowPass,
    RateDetector,
    beyond,
)


def test_a_touch_counts_along_its_axis_and_with_its_sign() -> None:
    touch = CusumTouch(drift_n=4.0, threshold_n=10.0, axis=1, sign=-1.0)
    detectors = ArmedDetectors(GuardLimits(touch=touch), 0, 0.0)
    along = [detectors.touched((-50.0, 20.0, 50.0, 0.0, 0.0, 0.0)) for _ in range(5)]
    against = [detectors.touched((0.0, -8.0, 0.0, 0.0, 0.0, 0.0)) for _ in range(3)]
    assert along == [False] * 5
    assert against == [False, False, True]


def test_low_pass_is_the_first_order_filter() -> None:
    signal = np.random.default_rng(3).normal(size=(200, 6))
    streaming = LowPass(5e-3)
    rows = [streaming.update(tuple(row), k * 1e-3) for k, row in enumerate(signal.tolist())]
    gain = -np.expm1(-1e-3 / 5e-3)
    start = (1.0 - gain) * signal[:1]
    expected, _ = lfilter([gain], [1.0, gain - 1.0], signal, axis=0, zi=start)
    assert np.allclose(rows, expected, atol=1e-12)


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
    frozen = FrozenDetector(3)
    a, b = (1.0,) * 6, (1.0,) * 5 + (2.0,)
    assert [frozen.update(value) for value in (a, a, b, b, b)] == [False] * 4 + [True]


def test_burst_forgets_after_its_window() -> None:
    burst = BurstDetector(3, 0.1, start=10)
    assert not burst.update(12, 0.0)
    assert not burst.update(13, 0.2)
    assert burst.update(15, 0.25)


@pytest.mark.parametrize(
    ("samples", "paused_s", "out"),
    [
        (500, 0.0, False),
        (500, 0.2, False),  # a box of its own sent on; what it sent waited in the socket
        (300, 0.2, False),  # a box that stood still with the machine
        (950, 0.2, True),  # too fast, whoever paused
        (200, 0.2, True),  # too slow even for the time in which the machine ran
        (200, 0.4, True),  # a machine that is away for longer excuses half of the window at most
        (0, 0.5, True),
    ],
)
def test_rate_on_a_machine_that_pauses(samples: int, paused_s: float, out: bool) -> None:
    rate = RateDetector((900.0, 1100.0), 0.5, now_s=10.0)
    for _ in range(samples):
        rate.add()
    rate.excuse(paused_s)
    assert not rate.check(10.499)
    assert rate.check(10.5) == out


def test_rate_excuses_a_pause_once() -> None:
    rate = RateDetector((900.0, 1100.0), 0.5, now_s=0.0)
    rate.excuse(0.2)
    for end_s, out in ((0.5, False), (1.0, True)):
        for _ in range(300):
            rate.add()
        assert rate.check(end_s) == out
