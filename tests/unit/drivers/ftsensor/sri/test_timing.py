import random
from itertools import pairwise

import pytest

from drivers.ftsensor.sri.timing import SampleClock


def stamps(rate_hz: float, delays_s: list[float], nominal_hz: float = 1000.0) -> list[float]:
    """Errors of the stamps against the true sample times."""
    clock = SampleClock(nominal_hz, 0.05)
    arrivals = [k / rate_hz + delay for k, delay in enumerate(delays_s)]
    return [clock.stamp(t, 1) - k / rate_hz for k, t in enumerate(arrivals)]


def test_jitter_is_removed() -> None:
    random.seed(1)
    delays = [2e-4 + random.expovariate(1 / 1e-3) for _ in range(5000)]
    errors = stamps(1000.0, delays)[1500:]
    assert max(errors) - min(errors) < 3e-4
    assert 0.0 < sum(errors) / len(errors) < 5e-4


def test_a_device_clock_that_is_off_is_followed() -> None:
    errors = stamps(1002.0, [3e-4] * 5000)
    assert max(abs(error) for error in errors[1100:]) < 4e-4


def test_bunched_frames_are_spread() -> None:
    clock = SampleClock(1000.0, 0.05)
    times = [clock.stamp((k // 16 + 1) * 0.016, 1, 15 - k % 16) for k in range(3200)]
    steps = [after - before for before, after in pairwise(times[1000:])]
    assert max(steps) < 1.05e-3
    assert min(steps) > 0.95e-3


def test_times_rise_and_never_lie_after_the_arrival() -> None:
    random.seed(2)
    clock = SampleClock(1000.0, 0.05)
    time_s, last = 0.0, -1.0
    for _ in range(3000):
        time_s += random.choice([0.0005, 0.001, 0.0015])
        stamp = clock.stamp(time_s, 1)
        assert last < stamp
        last = stamp


def test_the_rate_is_measured_and_judged() -> None:
    clock = SampleClock(1000.0, 0.05)
    for k in range(2000):
        clock.stamp(k / 300.0, 1)
    assert clock.rate_hz == pytest.approx(300.0, rel=0.01)
    assert clock.deviations >= 2


def test_a_pause_does_not_leave_old_stamps() -> None:
    clock = SampleClock(1000.0, 0.05)
    for k in range(1000):
        clock.stamp(k * 1e-3, 1)
    assert clock.stamp(3.0, 1) == pytest.approx(3.0)


def test_lost_frames_take_their_time() -> None:
    clock = SampleClock(1000.0, 0.05)
    for k in range(1200):
        clock.stamp(k * 1e-3, 1)
    assert clock.stamp(1.205, 6) == pytest.approx(1.205, abs=2e-4)


def read_at(clock: SampleClock, arrivals_s: list[float]) -> None:
    for arrival_s in arrivals_s:
        clock.stamp(arrival_s, 1)


def test_samples_that_stay_late_after_a_pause_are_seen() -> None:
    clock = SampleClock(1000.0, 0.05)
    read_at(clock, [k * 1e-3 for k in range(1000)])
    assert clock.lag_s == 0.0
    read_at(clock, [1.8 + k * 1e-3 for k in range(1100)])
    assert clock.lag_s == pytest.approx(0.8, abs=0.01)
    clock.restart()
    assert clock.lag_s == 0.0


def test_a_backlog_that_is_caught_up_with_is_no_lag() -> None:
    clock = SampleClock(1000.0, 0.05)
    read_at(clock, [k * 1e-3 for k in range(1000)])
    # The PC stood still for 0.8 s. What waited comes in four reads, then all is as before.
    for part in range(4):
        for k in range(200):
            clock.stamp(1.8 + 1e-4 * part, 1, 199 - k)
    read_at(clock, [1.801 + k * 1e-3 for k in range(1200)])
    assert clock.lag_s < 0.05


def test_samples_that_were_lost_are_no_lag() -> None:
    clock = SampleClock(1000.0, 0.05)
    read_at(clock, [k * 1e-3 for k in range(1000)])
    clock.stamp(1.8, 801)
    read_at(clock, [1.801 + k * 1e-3 for k in range(1200)])
    assert clock.lag_s == 0.0
