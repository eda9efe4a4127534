import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.insertion.with_feed import (
    ForceWithFeed,
    most_with_feed_n,
    with_feed_n,
)
from tests.unit.processes.peg_in_hole.tasks import pin

CELL = pin(stiffness_n_m=1e5, force_sigma_n=0.1).cell


def felt(with_feed: list[float], step_mm: float = 0.01) -> list[ContactSample]:
    return [
        ContactSample(
            0.008 * number,
            np.array([0.0, 0.0, (2.0 + number * step_mm) * 1e-3]),
            np.zeros(3),
            np.array([0.0, 0.0, force]),
            np.zeros(3),
            0.1,
        )
        for number, force in enumerate(with_feed)
    ]


def test_a_hole_that_holds_the_peg_back_shows_nothing() -> None:
    assert with_feed_n(felt([-0.5] * 50 + [-10.0] * 20), CELL) == 0.0


def test_a_zero_that_jumps_is_told_within_three_samples() -> None:
    watched = ForceWithFeed(CELL)
    told = [watched.take(sample) for sample in felt([-0.5] * 20 + [11.5] * 5)]
    assert told.index(True) == 22
    assert watched.greatest_n == pytest.approx(11.5)


def test_a_spike_is_none() -> None:
    assert with_feed_n(felt([-0.5] * 20 + [11.5] * 2 + [-0.5] * 20), CELL) < 0.1


def test_a_peg_that_was_drawn_back_may_be_held_until_the_arm_has_come_back() -> None:
    # 6 N have made the arm yield by 0.06 mm; friction turns round within twice that.
    turning = [6.0 - number for number in range(13)]
    assert with_feed_n(felt(turning + [-6.0] * 40), CELL) == 0.0
    # A zero that is wrong from the beginning stays so.
    assert with_feed_n(felt([6.0] * 60), CELL) == pytest.approx(6.0)


def test_the_limit_lies_above_the_noise() -> None:
    assert most_with_feed_n(CELL) == 2.0
    assert most_with_feed_n(pin(force_sigma_n=0.5).cell) == 4.0
