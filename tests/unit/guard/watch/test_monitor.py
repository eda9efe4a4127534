"""Every reason to stop, within a bounded number of samples, on a clock moved by hand."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from cellctl.errors.force import GuardRefused
from cellctl.guard.limits import LONGEST_BRAKING_S, UNLIMITED, CusumTouch, GuardLimits, Six
from cellctl.guard.report import TripReason
from cellctl.guard.watch.monitor import MOST_EXCUSED_S, WrenchMonitor
from cellctl.interfaces.ft_sensor import FtHealth
from tests.unit.guard.watch.samples import HEALTHY, flange, ready_monitor, sample

LIMITS = GuardLimits(raw=(50.0,) * 6, filtered=(35.0,) * 6, stale_s=0.005, flange_age_s=0.1)


def only(fz: float) -> Six:
    return (*UNLIMITED[:2], fz, *UNLIMITED[3:])


def armed(limits: GuardLimits = LIMITS, *, has_channel: bool = False) -> WrenchMonitor:
    monitor = ready_monitor(has_channel=has_channel)
    monitor.arm(limits, HEALTHY, 0.0)
    return monitor


def feed(
    monitor: WrenchMonitor, force: Callable[[int], float], most: int = 1000, begin: int = 1
) -> int | None:
    """One sample a millisecond until a trip: how many it took."""
    for k in range(most):
        time_s = (begin + k) * 1e-3
        monitor.sample(sample(time_s, force(k)))
        monitor.tick(time_s)
        if monitor.trip is not None:
            return k + 1
    return None


def reason(monitor: WrenchMonitor) -> TripReason | None:
    return None if monitor.trip is None else monitor.trip.reason


def test_quiet_samples_do_not_trip() -> None:
    assert feed(armed(), lambda _: 34.0) is None


def test_one_raw_sample_beyond_trips() -> None:
    monitor = armed()
    assert feed(monitor, lambda k: 51.0 if k == 7 else 0.0) == 8
    assert reason(monitor) is TripReason.RAW_LIMIT
    assert monitor.trip is not None
    assert (monitor.trip.component, monitor.trip.value) == (2, 51.0)
    assert "Fz 51.00 N, limit 50.00 N" in monitor.trip.detail


@pytest.mark.parametrize("component", ["fx", "fy", "mx", "my", "mz"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_every_component_and_both_signs(component: str, sign: float) -> None:
    monitor = armed()
    monitor.sample(sample(0.001, saturated=False, **{component: 51.0 * sign}))
    assert reason(monitor) is TripReason.RAW_LIMIT


def test_nan_counts_as_beyond() -> None:
    monitor = armed()
    monitor.sample(sample(0.001, math.nan))
    assert reason(monitor) is TripReason.RAW_LIMIT


def test_filtered_limit_passes_spikes_and_catches_a_step_in_time() -> None:
    monitor = armed()
    assert feed(monitor, lambda k: 49.0 if k % 7 == 0 else 0.0) is None
    # 1 − exp(−t / 5 ms) reaches 35 / 45 after 7.5 ms
    assert feed(monitor, lambda _: 45.0, begin=1001) in (7, 8, 9)
    assert reason(monitor) is TripReason.FILTERED_LIMIT


def test_touch() -> None:
    monitor = armed(replace(LIMITS, touch=CusumTouch()))
    assert feed(monitor, lambda k: 20.0 if k % 50 == 0 else 0.0) is None
    count = feed(monitor, lambda _: 10.1, begin=1001)
    assert count is not None
    assert count <= 20
    assert reason(monitor) is TripReason.TOUCH
    assert monitor.trip is not None
    assert monitor.trip.touch


def test_a_pull_is_no_touch() -> None:
    assert feed(armed(replace(LIMITS, touch=CusumTouch())), lambda _: -30.0) is None


def test_silence_trips_at_the_first_look_after_the_limit() -> None:
    monitor = armed()
    monitor.tick(0.0049)
    assert monitor.trip is None
    monitor.tick(0.0051)
    assert reason(monitor) is TripReason.SENSOR_SILENT


def test_a_stall_of_the_machine_is_no_silence_but_buys_no_more_than_itself() -> None:
    monitor = armed()
    monitor.excuse(0.050)
    monitor.tick(0.0549)
    assert monitor.trip is None
    monitor.tick(0.0551)
    assert reason(monitor) is TripReason.SENSOR_SILENT


TURN_S = 0.002


@pytest.mark.parametrize("late_s", [0.02, 0.05, 0.1])
def test_a_sensor_that_is_silent_while_the_machine_keeps_pausing_trips(late_s: float) -> None:
    monitor = armed()
    time_s = until_trip(monitor, late_s)
    assert reason(monitor) is TripReason.SENSOR_SILENT
    assert time_s <= LIMITS.stale_s + MOST_EXCUSED_S + late_s + TURN_S


@pytest.mark.parametrize("late_s", [0.02, 0.05, 0.1])
def test_a_robot_that_is_silent_while_the_machine_keeps_pausing_trips(late_s: float) -> None:
    monitor = armed(has_channel=True)
    time_s = until_trip(monitor, late_s, samples=True)
    assert reason(monitor) is TripReason.FLANGE_STALE
    assert time_s <= LIMITS.flange_age_s + MOST_EXCUSED_S + late_s + TURN_S


def until_trip(monitor: WrenchMonitor, late_s: float, *, samples: bool = False) -> float:
    """Turns as the loop takes them, each of them late; the time of the trip, at most 2 s."""
    time_s = 0.0
    while monitor.trip is None and time_s < 2.0:
        time_s += TURN_S + late_s
        monitor.excuse(late_s)
        if samples:
            monitor.sample(sample(time_s))
        monitor.tick(time_s)
    return time_s


def test_frozen_values() -> None:
    monitor = armed()
    still = sample(0.001, 1.0)
    counts = []
    for k in range(20):
        monitor.sample(still._replace(receive_time_s=k * 1e-3, time_s=k * 1e-3, number=k))
        counts.append(monitor.trip is not None)
    assert counts.index(True) == LIMITS.frozen_samples - 1
    assert reason(monitor) is TripReason.SENSOR_FROZEN


def test_saturation() -> None:
    monitor = armed()
    monitor.sample(sample(0.001, saturated=True))
    assert reason(monitor) is TripReason.SENSOR_SATURATED


@pytest.mark.parametrize("counter", ["checksum_errors", "invalid"])
def test_a_burst_of_damaged_frames(counter: str) -> None:
    monitor = armed()
    for k in range(1, 3):
        monitor.sensor_health(FtHealth(**{counter: k}), k * 1e-3)
        assert monitor.trip is None
    monitor.sensor_health(FtHealth(**{counter: 3}), 3e-3)
    assert reason(monitor) is TripReason.SENSOR_INVALID


def test_single_damaged_frames_far_apart_are_tolerated() -> None:
    monitor = armed()
    for k in range(50):
        monitor.sensor_health(FtHealth(checksum_errors=k), k * 0.06)
    assert monitor.trip is None


def test_damage_before_arming_does_not_count() -> None:
    monitor = ready_monitor()
    monitor.arm(LIMITS, FtHealth(checksum_errors=50), 0.0)
    monitor.sensor_health(FtHealth(checksum_errors=51), 0.001)
    assert monitor.trip is None


@pytest.mark.parametrize(("period", "trips"), [(1, False), (2, True)])
def test_rate(period: int, trips: bool) -> None:
    monitor = armed(replace(LIMITS, rate_hz=(900.0, 1100.0), rate_window_s=0.1))
    for k in range(1, 300):
        time_s = k * 1e-3
        if k % period == 0:
            monitor.sample(sample(time_s))
        monitor.tick(time_s)
    assert (reason(monitor) is TripReason.SENSOR_RATE) == trips


def test_an_old_flange_pose() -> None:
    monitor = armed(has_channel=True)
    assert feed(monitor, lambda _: 0.0) == 101
    assert reason(monitor) is TripReason.FLANGE_STALE


def test_a_trip_stays_until_it_is_acknowledged() -> None:
    monitor = armed()
    feed(monitor, lambda _: 60.0)
    first = monitor.trip
    feed(monitor, lambda _: 0.0)
    monitor.tick(10.0)
    assert monitor.trip is first
    monitor.disarm()
    assert monitor.trip is first
    with pytest.raises(GuardRefused, match="latched"):
        monitor.arm(LIMITS, HEALTHY, 0.0)
    monitor.acknowledge()
    assert (monitor.trip, monitor.armed) == (None, False)


def test_nothing_trips_while_disarmed() -> None:
    monitor = ready_monitor(has_channel=True)
    monitor.sample(sample(0.001, 1e6, saturated=True))
    monitor.tick(100.0)
    monitor.stop(TripReason.STOP_CHANNEL_LOST, 100.0, "gone")
    assert monitor.trip is None


def test_peaks_outlast_the_trip_and_end_with_a_tare() -> None:
    monitor = armed()
    feed(monitor, lambda _: 60.0)
    monitor.sample(sample(0.002, -80.0))
    assert monitor.peak_raw[2] == 80.0
    assert 0.0 < monitor.peak_filtered[2] < 80.0
    monitor.acknowledge()
    monitor.begin_tare(0.05, 0.003)
    feed(monitor, lambda _: 5.0, most=60, begin=3)
    assert monitor.peak_raw[2] < 1e-6


def test_tare_takes_the_mean_and_is_told_untared() -> None:
    monitor = ready_monitor()
    for expected in (5.0, 7.0):
        begin_s = monitor.sample_time_s + 0.001
        monitor.begin_tare(0.1, begin_s)
        for k in range(101):
            last = monitor.sample(sample(begin_s + k * 1e-3, expected + (k % 2 - 0.5)))
        assert monitor.tare_result is not None
        assert monitor.tare_result.mean[2] == pytest.approx(expected, abs=0.01)
        assert monitor.tare_result.sigma[2] == pytest.approx(0.5, rel=0.05)
        assert monitor.tare_result.samples == 101
        last = monitor.sample(sample(begin_s + 0.102, expected))
        assert last[2] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(
    ("prepare", "words"),
    [
        (lambda m: setattr(m.contact, "gravity_compensated", False), "compensation"),
        (lambda m: setattr(m, "channel_up", False), "stop channel"),
        (lambda m: setattr(m, "flange_time_s", -1.0), "flange pose"),
        (lambda m: setattr(m, "sample_time_s", -math.inf), "sample"),
        (lambda m: m.begin_tare(1.0, 0.0), "tare"),
    ],
)
def test_arming_is_refused(prepare: Callable[[WrenchMonitor], None], words: str) -> None:
    monitor = ready_monitor(has_channel=True)
    prepare(monitor)
    with pytest.raises(GuardRefused, match=words):
        monitor.arm(LIMITS, HEALTHY, 0.0)
    assert not monitor.armed


def test_what_changes_the_signal_is_refused_while_armed() -> None:
    monitor = armed()
    with pytest.raises(GuardRefused):
        monitor.require_unarmed()
    with pytest.raises(GuardRefused):
        monitor.begin_tare(0.1, 0.0)


def test_arming_again_replaces_the_limits() -> None:
    monitor = armed()
    monitor.arm(GuardLimits(raw=only(10.0), stale_s=1.0), HEALTHY, 0.0)
    assert feed(monitor, lambda _: 11.0) == 1


def test_a_flange_pose_turns_the_load() -> None:
    monitor = ready_monitor(has_channel=True)
    load = [(100.0, 0.0, 0.0), (0.0, 100.0, 0.0), (0.0, 0.0, 100.0)] + [(0.0, 0.0, 0.0)] * 3
    monitor.contact.set_gravity_compensation(load, (0.0,) * 6, (0.0, 0.0, -1.0))
    upside_down = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
    assert monitor.sample(sample(0.001, -100.0))[2] == pytest.approx(0.0)
    monitor.flange(flange(0.001, upside_down))
    assert monitor.sample(sample(0.002, 100.0))[2] == pytest.approx(0.0)


BRAKING = replace(LIMITS, braking=(200.0, 200.0, 200.0, 20.0, 20.0, 20.0))


def test_what_the_load_makes_of_the_brakes_is_no_contact() -> None:
    monitor = armed(BRAKING)
    monitor.brake(0.0)
    assert feed(monitor, lambda _: 190.0) is None
    assert feed(monitor, lambda _: 201.0, begin=1001) == 1
    assert reason(monitor) is TripReason.RAW_LIMIT


def test_without_a_stop_that_was_asked_for_the_limits_are_those_of_the_move() -> None:
    assert feed(armed(BRAKING), lambda _: 51.0) == 1


def test_braking_makes_no_limit_tighter() -> None:
    monitor = armed(BRAKING)
    monitor.brake(0.0)
    for k in range(1, 100):
        monitor.sample(sample(k * 1e-3, mx=34.0))
    assert monitor.trip is None


def test_braking_ends_and_the_limits_of_the_move_hold_again() -> None:
    monitor = armed(BRAKING)
    monitor.brake(0.0)
    end = round(LONGEST_BRAKING_S * 1e3)
    assert feed(monitor, lambda _: 0.0, most=end + 2) is None
    assert feed(monitor, lambda _: 51.0, begin=end + 3) == 1
