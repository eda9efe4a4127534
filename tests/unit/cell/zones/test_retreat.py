"""Two arms that stand in one zone: who leads out first, and by which way."""

import asyncio

import numpy as np
import pytest

from cellctl.cell.zones.ways import FlangeWay, UnknownWay
from cellctl.cell.zones.zone import Share
from cellctl.errors.robot import ZoneTaken
from tests.unit.cell.zones.loop import run, time_s
from tests.unit.cell.zones.rail import LEFT, RIGHT, SPEED, TICK_S, ZONE, Rail, at, rail

SHARE = Share(ZONE, (), (0, False))


async def move(cell: Rail, name: str, x_m: float) -> None:
    await cell.zoned[name].move_linear(at(x_m), **SPEED)


def both(wait_s: float = 30.0) -> Rail:
    return rail(a=1.25, b=1.75, c=RIGHT, retreat=("a", "b"), wait_s=wait_s)


def test_without_an_order_both_are_refused() -> None:
    async def work() -> None:
        cell = rail(a=1.25, b=1.75)
        for name, place_m in (("a", LEFT), ("b", RIGHT)):
            with pytest.raises(ZoneTaken, match="stands in it"):
                await move(cell, name, place_m)
        assert time_s() == 0.0

    run(work())


def test_the_first_one_leads_out_and_then_the_other() -> None:
    async def work() -> None:
        cell = both()
        await move(cell, "a", LEFT)
        await move(cell, "b", RIGHT)
        assert cell.inside() == []

    run(work())


def test_the_other_one_waits_for_the_first() -> None:
    async def work() -> None:
        cell = both()
        second = asyncio.create_task(move(cell, "b", RIGHT))
        await asyncio.sleep(5 * TICK_S)
        assert cell.robots["b"].started == 0
        await move(cell, "a", LEFT)
        await second
        assert cell.inside() == []

    run(work())


def test_it_does_not_wait_for_ever() -> None:
    async def work() -> None:
        cell = both(wait_s=2.0)
        with pytest.raises(ZoneTaken, match="a stands in it and leaves first"):
            await move(cell, "b", RIGHT)
        assert 2.0 <= time_s() < 3.5
        assert cell.robots["b"].started == 0

    run(work())


def test_a_way_past_the_other_arm_leads_not_out() -> None:
    async def work() -> None:
        cell = both()
        with pytest.raises(ZoneTaken, match="b stands in it"):
            await move(cell, "a", RIGHT)
        with pytest.raises(ZoneTaken, match="b stands in it"):
            await move(cell, "a", 1.1)
        assert cell.robots["a"].started == 0

    run(work())


def test_nobody_leads_out_past_an_arm_that_moves() -> None:
    async def work() -> None:
        cell = both()
        cell.robots["b"].looks = {"moving": True}
        with pytest.raises(ZoneTaken, match="b stands in it"):
            await move(cell, "a", LEFT)

    run(work())


def test_a_third_arm_stays_out_meanwhile() -> None:
    async def work() -> None:
        cell = both()
        leaving = asyncio.create_task(move(cell, "a", LEFT))
        await asyncio.sleep(0)
        with pytest.raises(ZoneTaken):
            await move(cell, "c", 1.9)
        await leaving
        assert cell.robots["c"].started == 0

    run(work())


def test_an_arm_that_is_not_named_leaves_last() -> None:
    async def work() -> None:
        cell = rail(a=1.25, b=1.75, retreat=("a",), wait_s=1.0)
        with pytest.raises(ZoneTaken):
            await move(cell, "b", RIGHT)
        await move(cell, "a", LEFT)
        await move(cell, "b", RIGHT)

    run(work())


def way(*points: tuple[float, float, float]) -> FlangeWay:
    return FlangeWay(np.array(points))


@pytest.mark.parametrize(
    ("one", "out"),
    [
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0)), True),
        (way((1.2, 0.0, 0.0), (1.1, 0.0, 0.0)), False),
        (way((1.2, 0.0, 0.0), (2.5, 0.0, 0.0)), False),
        # Out, in again and out: as a joint move may swing.
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0), (1.1, 0.0, 0.0), (0.5, 0.0, 0.0)), False),
        (way((0.5, 0.0, 0.0), (0.2, 0.0, 0.0)), False),
        # Out, but through another face than the one that is meant.
        (way((1.2, 0.0, 0.0), (1.2, 0.0, 1.5)), False),
        (way((1.8, 0.0, 0.0), (1.2, 0.4, 0.0), (0.9, 0.0, 0.0)), True),
        # To the side as a way out: far along the face with a hair of gain, straight or on the way.
        (way((1.0005, -0.9, 0.0), (0.9995, 0.9, 0.0)), False),
        (way((1.02, -0.45, 0.0), (0.98, 0.45, 0.0)), False),
        (way((1.5, -0.5, 0.0), (1.499, 0.5, 0.0), (0.9, 0.5, 0.0)), False),
        (way(*((1.5 - 0.0001 * n, 0.01 * n, 0.0) for n in range(50)), (0.9, 0.5, 0.0)), False),
        # With gain enough on each stretch, but a long way round.
        (way((1.8, -0.9, 0.0), (1.6, 0.9, 0.0), (0.9, 0.9, 0.0)), False),
        # Oblique ways home, which end far beyond the face and to the side.
        (way((1.02, 0.0, 0.0), (0.98, 0.4, 0.0)), True),
        (way((1.5, 0.0, 0.0), (0.2, 0.9, 0.9)), True),
        (way((1.001, 0.0, 0.0), (0.5, 5.0, 0.0)), True),
        (way((1.2, 0.0, 0.0), (1.21, 0.0, 0.0), (0.9, 0.0, 0.0)), False),
        # Away from the face by a hair at each of many points, as a joint move may swing.
        (way(*((1.2 + 0.0009 * n, 0.0, 0.0) for n in range(50)), (0.9, 0.0, 0.0)), False),
        (way((1.2, 0.0, 0.0), (1.2009, 0.0, 0.0), (1.2, 0.0, 0.0), (0.9, 0.0, 0.0)), True),
        # Beyond the face it may turn to any side, but not past the box back into it.
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0), (0.9, 0.0, 0.0)), True),
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 5.0, 0.0), (1.5, 5.0, 0.0)), True),
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 5.0, 0.0), (1.5, 0.0, 0.0)), False),
        (way((1.2, 0.0, 0.0), (0.5, 0.0, 0.0), (np.nan, 0.0, 0.0)), False),
        (way((1.2, 0.0, 0.0), (np.nan, 0.0, 0.0)), False),
        (FlangeWay(np.array([[1.2, 0.0, 0.0], [0.5, 0.0, 0.0]]), 0.1), False),
        (UnknownWay(np.array([1.2, 0.0, 0.0]), np.zeros(6), np.ones(6)), False),
    ],
)
def test_which_ways_lead_out(one: FlangeWay | UnknownWay, out: bool) -> None:
    assert one.leads_out(SHARE) is out
    assert not one.leads_out(Share(ZONE, ())), "nobody has said where the way out is"
