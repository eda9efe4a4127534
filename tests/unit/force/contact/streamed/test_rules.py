"""Rules of ticks, refusals and speeds: sections 3.2, 4.1, 4.2 and 4.4 of the study."""

import numpy as np
import pytest

from cellctl.errors.streamed_contact import (
    LoopNotMeasured,
    LoopTooSlow,
    LoopUnstable,
    StreamLate,
)
from cellctl.force.contact.streamed.gains import (
    LoopFigures,
    check_load,
    check_press,
    check_speed,
    contact_load,
    damping,
    levers,
)
from cellctl.force.contact.streamed.path import PathFollower, straight
from cellctl.force.contact.streamed.speeds import ContactWatch, feed_override, touch_speed_m_s
from cellctl.force.contact.streamed.ticks import Pace, TickRules
from cellctl.force.contact.streamed.wrench_filter import WrenchFilter, left_of_noise

MIDDLE = LoopFigures(1e6, 24e-3)


@pytest.mark.parametrize(("stiffness", "dead_s"), [(0.0, 0.02), (1e6, float("nan")), (-1.0, 0.02)])
def test_figures_that_are_no_measurement_are_refused(stiffness: float, dead_s: float) -> None:
    with pytest.raises(LoopNotMeasured, match="F576"):
        LoopFigures(stiffness, dead_s)


def test_designed_gains_leave_their_margin_and_softer_ones_are_refused() -> None:
    weights = levers(0.014)
    designed = damping(MIDDLE, weights, 3)
    all_six = np.ones(6, dtype=bool)
    # One axis of each three can be loaded fully at a time: two of the three shares of 2/9.
    load = contact_load(MIDDLE, 0.014, designed, all_six)
    assert load == pytest.approx(4 / 9)
    check_load(load)
    with pytest.raises(LoopUnstable, match=r"F578.*1\.33, at most 0\.70"):
        check_load(contact_load(MIDDLE, 0.014, damping(MIDDLE, weights, 1), all_six))


def test_a_loop_that_hardly_moves_is_refused_with_its_figures() -> None:
    check_press(MIDDLE, 8.0, 1.5 * MIDDLE.loop_n_s_m)
    stiff = LoopFigures(1e7, 24e-3)
    with pytest.raises(LoopTooSlow, match=r"F577.*0\.022 mm/s.*1e\+07 N/m.*24 ms"):
        check_press(stiff, 8.0, 1.5 * stiff.loop_n_s_m)


def test_a_speed_that_takes_over_half_of_the_limit_is_refused() -> None:
    check_speed(0.15e-3, 36e3, 20.0)
    with pytest.raises(LoopUnstable, match=r"36\.0 N are needed"):
        check_speed(1e-3, 36e3, 50.0)


@pytest.mark.parametrize(
    ("tick_s", "force_s", "pace"),
    [
        (4e-3, 1e-3, Pace.STEP),
        (5.9e-3, 1e-3, Pace.STEP),
        (6.1e-3, 1e-3, Pace.HOLD),
        (12.1e-3, 1e-3, Pace.BRAKE),
        (4e-3, 5.1e-3, Pace.BRAKE),
    ],
)
def test_pace_after_a_tick(tick_s: float, force_s: float, pace: Pace) -> None:
    assert TickRules(4e-3).pace(tick_s, force_s) is pace


@pytest.mark.parametrize(
    ("period_s", "tick_s", "force_s"),
    [(4e-3, 41e-3, 0.0), (12e-3, 51e-3, 0.0), (4e-3, 4e-3, 21e-3)],
)
def test_too_late_ends_the_stream(period_s: float, tick_s: float, force_s: float) -> None:
    with pytest.raises(StreamLate, match="F589"):
        TickRules(period_s).pace(tick_s, force_s)


@pytest.mark.parametrize(("stiffness", "mm_s"), [(1e5, 1.48), (1e6, 0.148), (3e6, 0.049)])
def test_touch_speeds_of_the_study(stiffness: float, mm_s: float) -> None:
    speed = touch_speed_m_s(LoopFigures(stiffness, 24e-3), 8.0)
    assert speed * 1e3 == pytest.approx(mm_s, rel=0.01)
    assert touch_speed_m_s(LoopFigures(1e4, 24e-3), 8.0) == 3e-3


def test_the_feed_is_full_below_an_eighth_and_backs_off_above_six_tenths() -> None:
    shares = [feed_override(force_n, 30.0) for force_n in (0.0, 3.6, 18.0, 25.2, 60.0)]
    assert shares == pytest.approx([1.0, 1.0, 0.0, -0.5, -0.5])


def test_a_contact_is_lost_after_twenty_milliseconds() -> None:
    watch = ContactWatch(8.0, 4e-3)
    assert [watch.lost(force_n) for force_n in (8.0, 2, 2, 2, 2, 2, 2, 8.0)] == [
        *(False,) * 5,
        True,
        True,
        False,
    ]


def test_a_path_ends_at_rest_and_keeps_its_bounds() -> None:
    points, lengths = straight(np.zeros(6), np.array([3e-3, 4e-3, 0, 0, 0, 0]), 0.1)
    path = PathFollower(points, lengths, 0.1, 4e-3)
    went = [np.zeros(6)]
    while not path.arrived:
        went.append(path.step(10e-3))
        assert len(went) < 400
    speeds = np.linalg.norm(np.diff(went, axis=0), axis=1) / 4e-3
    assert np.allclose(went[-1], points[-1])
    assert speeds.max() == pytest.approx(10e-3)
    assert np.abs(np.diff(speeds)).max() <= 0.1 * 4e-3 * 1.01
    assert speeds[-1] <= 0.1 * 4e-3 * 1.01


def test_a_path_goes_backwards_to_its_begin_only() -> None:
    points, lengths = straight(np.zeros(6), np.array([0, 0, 1e-3, 0, 0, 0]), 0.1)
    path = PathFollower(points, lengths, 0.1, 4e-3)
    for _ in range(20):
        path.step(2e-3)
    for _ in range(400):
        back = path.step(-1e-3)
    assert np.allclose(back, 0.0)
    assert path.speed == 0.0


def test_the_filter_is_exact_at_any_times_and_leaves_the_noise_it_says() -> None:
    rng = np.random.default_rng(3)
    low = WrenchFilter(2e-3)
    low.take(np.array([0.0]), np.zeros((1, 6)))
    low.take(np.array([1e-3, 4e-3]), np.ones((2, 6)))
    assert low.value == pytest.approx(np.full(6, 1 - np.exp(-2.0)))
    left = []
    for index in range(20_000):
        low.take(np.array([0.01 + index * 1e-3]), rng.normal(0.0, 1.0, (1, 6)))
        left.append(low.value[0])
    assert np.std(left) == pytest.approx(left_of_noise(2e-3, 1e-3), rel=0.05)
