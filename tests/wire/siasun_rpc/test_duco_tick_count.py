"""When a PC that counts the ticks of a stream itself begins them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.robot.siasun_rpc.tick_count import TickCount

T_S = 0.010


def begun(busy_s: list[float]) -> tuple[TickCount, list[float]]:
    """Beginnings of ticks whose setpoints keep the PC busy for these times."""
    ticks, now_s, begins_s = TickCount(T_S, 100.0), 100.0, [100.0]
    for each_s in busy_s:
        now_s += each_s
        begins_s.append(ticks.begin_next(now_s))
        now_s = max(now_s, begins_s[-1])
    return ticks, begins_s


def test_a_quick_pc_keeps_to_the_grid() -> None:
    ticks, begins_s = begun([0.002, 0.009, 0.0, 0.0099])
    np.testing.assert_allclose(np.diff(begins_s), T_S)
    assert (ticks.tick, ticks.lost) == (5, 0)


def test_a_pc_that_needs_a_little_more_than_a_period_loses_no_tick() -> None:
    ticks, begins_s = begun([0.012] * 20)
    np.testing.assert_allclose(np.diff(begins_s), 0.012)
    assert (ticks.tick, ticks.lost) == (21, 0)


@pytest.mark.parametrize(("busy_s", "lost"), [(0.0151, 1), (0.0199, 1), (0.0201, 2), (0.0551, 5)])
def test_what_comes_later_loses_ticks(busy_s: float, lost: int) -> None:
    ticks, begins_s = begun([busy_s])
    assert (ticks.tick, ticks.lost) == (2 + lost, lost)
    assert begins_s[1] == pytest.approx(100.0 + (1 + lost) * T_S)


@given(st.lists(st.floats(0.0, 0.1), min_size=1, max_size=30))
def test_no_tick_is_shorter_than_a_period_and_none_begins_before_it_is_asked_for(
    busy_s: list[float],
) -> None:
    ticks, begins_s = begun(busy_s)
    assert (np.diff(begins_s) >= T_S - 1e-9).all()
    assert ticks.tick == len(busy_s) + 1 + ticks.lost
    assert ticks.end_s == pytest.approx(begins_s[-1] + T_S)
