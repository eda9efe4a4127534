"""How hard an arm presses on what it leaves, and what change of force that allows."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from cellctl.cell.guarded_motion.leaving import change_while_drawn_n, pressed_n
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.force import LiftOffHeld
from tests.unit.cell.guard import TinyGuard

MOST_N = 50.0


async def pressed(told_n: float, hidden_n: float | None, inwards: float = 1.0) -> float:
    guard = TinyGuard(hidden_axial_n=hidden_n)
    guard.raw = np.tile([3.0, -3.0, told_n, 0.1, 0.1, 0.0], (50, 1))
    arm = cast(GuardedRobot, SimpleNamespace(guard=guard, zero_file=None))
    return await pressed_n(arm, inwards, MOST_N)


@pytest.mark.parametrize(
    ("told_n", "hidden_n", "found_n"),
    [(-25.0, 0.0, 25.0), (7.0, -25.0, 18.0), (0.0, -25.0, 25.0), (4.0, 0.0, -4.0), (-80.0, 0, 50)],
    ids=["pressed", "half relieved", "from a zero in contact", "pulled", "more than can be"],
)
async def test_what_a_zero_hides_counts(told_n: float, hidden_n: float, found_n: float) -> None:
    assert await pressed(told_n, hidden_n) == pytest.approx(found_n)
    assert await pressed(-told_n, -hidden_n, inwards=-1.0) == pytest.approx(found_n)


async def test_without_a_zero_it_is_the_most_that_can_be() -> None:
    assert await pressed(-3.0, None) == MOST_N


def test_a_part_that_is_pulled_already_has_the_less_left() -> None:
    assert change_while_drawn_n(20.0, 30.0) == 50.0
    assert change_while_drawn_n(20.0, -12.0) == 8.0
    with pytest.raises(LiftOffHeld, match="pulled with 18 N already, allowed 20 N"):
        change_while_drawn_n(20.0, -18.0)
