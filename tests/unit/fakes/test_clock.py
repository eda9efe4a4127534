"""The clock of a fake cell loses what the PC could not give."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes.clock import LONGEST_STEP_S, WorldClock


class Pc:
    """A PC whose time passes when the test says so."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


def test_short_waits_pass_whole() -> None:
    pc = Pc()
    clock = WorldClock(pc)
    for _ in range(100):
        pc.now_s += 0.9 * LONGEST_STEP_S
        clock()
    assert clock() == pytest.approx(90 * LONGEST_STEP_S)
    assert clock.lost_s == 0


def test_a_stall_of_the_pc_does_not_pass_in_the_world() -> None:
    pc = Pc()
    clock = WorldClock(pc)
    pc.now_s += 0.5
    assert clock() == pytest.approx(LONGEST_STEP_S)
    assert clock() == pytest.approx(LONGEST_STEP_S), "nothing is caught up later"
    assert clock.lost_s == pytest.approx(0.5 - LONGEST_STEP_S)


@given(st.lists(st.floats(0.0, 0.3), max_size=50))
def test_what_passed_and_what_was_lost_are_the_time_of_the_pc(steps_s: list[float]) -> None:
    pc = Pc()
    clock = WorldClock(pc)
    before_s = 0.0
    for step_s in steps_s:
        pc.now_s += step_s
        now_s = clock()
        assert before_s <= now_s <= before_s + LONGEST_STEP_S + 1e-9
        before_s = now_s
    assert clock() + clock.lost_s == pytest.approx(sum(steps_s), abs=1e-9)
