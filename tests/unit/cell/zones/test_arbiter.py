"""Who may move into a zone: by reports, by moves under way, and by doubt."""

import asyncio

import numpy as np
import pytest

from cellctl.errors.link import LinkLost
from cellctl.errors.robot import MotionAborted, NotRearmed, ZoneTaken
from tests.unit.cell.zones.loop import run, time_s
from tests.unit.cell.zones.rail import LEFT, MIDDLE, RIGHT, SPEED, TICK_S, Rail, at, rail


async def move(cell: Rail, name: str, x_m: float) -> None:
    await cell.zoned[name].move_linear(at(x_m), **SPEED)


def test_an_arm_that_reports_itself_in_the_zone_keeps_the_other_out() -> None:
    # Nobody has commanded b there: it stood there when the daemon started.
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE)
        with pytest.raises(ZoneTaken, match="middle: b stands in it"):
            await move(cell, "a", MIDDLE)
        assert cell.robots["a"].started == 0, "refused before anything moved"
        assert time_s() == 0.0, "an arm that stands is not waited for"

    run(work())


def test_a_straight_move_through_the_zone_needs_it_though_it_ends_outside() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE)
        with pytest.raises(ZoneTaken):
            await move(cell, "a", RIGHT)
        await move(cell, "a", 0.75)

    run(work())


def test_two_moves_into_the_zone_at_once_let_one_in() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        ends = await asyncio.gather(
            move(cell, "a", MIDDLE), move(cell, "b", MIDDLE), return_exceptions=True
        )
        assert ends[0] is None
        assert isinstance(ends[1], ZoneTaken)
        assert "on its way into it" in str(ends[1])
        assert cell.robots["b"].started == 0

    run(work())


def test_an_arm_waits_for_one_that_is_leaving() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE)
        leaving = asyncio.create_task(move(cell, "b", RIGHT))
        await asyncio.sleep(0)
        await move(cell, "a", MIDDLE)
        assert leaving.done()
        assert cell.robots["a"].x_m == MIDDLE

    run(work())


def test_an_arm_that_leaves_for_too_long_is_not_waited_for() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE, wait_s=0.05)
        leaving = asyncio.create_task(move(cell, "b", RIGHT))
        await asyncio.sleep(0)
        with pytest.raises(ZoneTaken, match="on its way out"):
            await move(cell, "a", MIDDLE)
        await leaving

    run(work())


def test_an_arm_whose_place_is_not_known_takes_the_zone() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        cell.robots["b"].silent = LinkLost("cut")
        with pytest.raises(ZoneTaken, match=r"its place is not known .*cut"):
            await move(cell, "a", MIDDLE)
        assert cell.robots["a"].started == 0
        assert time_s() < 2.0, "a report may be late, but not for long"

    run(work())


def test_a_place_that_is_not_a_number_takes_the_zone() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        cell.robots["b"].looks = {"base_T_flange": at(np.nan)}
        with pytest.raises(ZoneTaken):
            await move(cell, "a", MIDDLE)

    run(work())


def test_an_arm_that_is_jogged_takes_the_zone() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        cell.robots["b"].looks = {"moving": True}
        with pytest.raises(ZoneTaken, match="without a command of this PC"):
            await move(cell, "a", MIDDLE)

    run(work())


def test_reports_that_stay_away_after_a_move_take_the_zone() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        await move(cell, "b", 2.5)
        cell.robots["b"].looks = {"time_s": time_s() - 0.01}
        with pytest.raises(ZoneTaken, match="since its last move"):
            await move(cell, "a", MIDDLE)

    run(work())


def test_an_aborted_arm_in_the_zone_is_the_only_one_that_may_move_out() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        entering = asyncio.create_task(move(cell, "b", MIDDLE))
        # From 3 m by 0.25 m a tick: after four ticks it is at 2 m, and then it brakes.
        await asyncio.sleep(4.5 * TICK_S)
        assert cell.inside() == ["b"]
        await cell.zoned["b"].stop()
        with pytest.raises(MotionAborted):
            await entering
        await cell.zoned["b"].rearm()
        with pytest.raises(ZoneTaken, match="b stands in it"):
            await move(cell, "a", RIGHT)
        await asyncio.sleep(TICK_S)
        await move(cell, "b", RIGHT)
        await move(cell, "a", MIDDLE)

    run(work())


def test_an_arm_that_still_brakes_into_the_zone_takes_it() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=RIGHT)
        entering = asyncio.create_task(move(cell, "b", MIDDLE))
        # After three ticks it is at 2.25 m, outside; braking leads it to 2 m, inside.
        await asyncio.sleep(3.5 * TICK_S)
        await cell.zoned["b"].stop()
        with pytest.raises(MotionAborted):
            await entering
        assert cell.inside() == []
        with pytest.raises(ZoneTaken, match="b stands in it"):
            await move(cell, "a", MIDDLE)
        assert cell.inside() == ["b"]

    run(work())


def test_two_arms_that_share_the_zone_already_are_left_to_a_person() -> None:
    async def work() -> None:
        cell = rail(a=1.25, b=1.75)
        for name, out_m in (("a", LEFT), ("b", RIGHT)):
            with pytest.raises(ZoneTaken, match="stands in it"):
                await move(cell, name, out_m)

    run(work())


def test_a_stop_gives_up_a_move_that_waits_even_when_the_robot_is_rearmed() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE)
        leaving = asyncio.create_task(move(cell, "b", RIGHT))
        await asyncio.sleep(0)
        waiting = asyncio.create_task(move(cell, "a", MIDDLE))
        await asyncio.sleep(0)
        await cell.zoned["a"].stop()
        await cell.zoned["a"].rearm()
        with pytest.raises(NotRearmed, match="while it waited"):
            await waiting
        assert not leaving.done(), "at once, not when the zone is free"
        await leaving
        assert cell.robots["a"].started == 0

    run(work())


def test_a_wait_that_is_cancelled_leaves_nothing_behind() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE, c=LEFT)
        leaving = asyncio.create_task(move(cell, "b", RIGHT))
        await asyncio.sleep(0)
        waiting = asyncio.create_task(move(cell, "a", MIDDLE))
        await asyncio.sleep(0)
        waiting.cancel()
        await leaving
        await move(cell, "c", MIDDLE)
        assert cell.robots["a"].started == 0

    run(work())


def test_without_kinematics_only_moves_between_clear_poses_are_free() -> None:
    async def work() -> None:
        cell = rail(a=LEFT, b=MIDDLE)
        a = cell.zoned["a"]
        # Taught so that the way between them is free, wherever it leads.
        await a.move_joint(np.full(6, RIGHT), speed_ratio=0.5)
        with pytest.raises(ZoneTaken):
            await a.move_joint(np.full(6, 2.5), speed_ratio=0.5)
        with pytest.raises(ZoneTaken):
            await a.move_joint(np.full(6, np.nan), speed_ratio=0.5)
        with pytest.raises(ZoneTaken):
            await a.step(at(MIDDLE), speed_m_s=0.1)

    run(work())
