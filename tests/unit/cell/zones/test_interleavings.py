"""Whatever three arms are told, and whenever they are stopped: no two of them share the zone."""

import asyncio
from dataclasses import dataclass

from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.errors.base import CellError
from tests.rigs.sweeps import examples
from tests.unit.cell.zones.loop import run
from tests.unit.cell.zones.rail import SPEED, TICK_S, Rail, at, rail

NAMES = ("a", "b", "c")
PLACES = (0.0, 0.75, 1.25, 1.75, 2.25, 3.0)


@dataclass(frozen=True)
class Order:
    """What one arm is told, and when."""

    robot: str
    pause_ticks: int
    kind: str
    place_m: float


orders = st.lists(
    st.builds(
        Order,
        st.sampled_from(NAMES),
        st.integers(0, 6),
        st.sampled_from(["move", "move", "move", "stop", "cancel"]),
        st.sampled_from(PLACES),
    ),
    max_size=16,
)


async def obey(cell: Rail, order: Order, moves: dict[str, asyncio.Task[object]]) -> None:
    await asyncio.sleep(order.pause_ticks * TICK_S)
    robot = cell.zoned[order.robot]
    if order.kind == "stop":
        await robot.stop()
        await robot.rearm()
    elif order.kind == "cancel" and order.robot in moves:
        moves[order.robot].cancel()
        await asyncio.gather(moves[order.robot], return_exceptions=True)
        await robot.rearm()
    elif order.kind == "move" and (order.robot not in moves or moves[order.robot].done()):
        moves[order.robot] = asyncio.create_task(robot.move_linear(at(order.place_m), **SPEED))


async def play(cell: Rail, told: list[Order]) -> int:
    """Carry out the orders; returns how many looks found an arm in the zone."""
    moves: dict[str, asyncio.Task[object]] = {}
    seen = 0

    async def watch() -> None:
        nonlocal seen
        while True:
            inside = cell.inside()
            assert len(inside) <= 1, f"{inside} share the zone"
            seen += len(inside)
            await asyncio.sleep(TICK_S / 2)

    watching = asyncio.create_task(watch())
    for order in told:
        await obey(cell, order, moves)
    ends = await asyncio.gather(*moves.values(), return_exceptions=True)
    assert all(not isinstance(end, Exception) or isinstance(end, CellError) for end in ends)
    assert not watching.done() or watching.result() is None
    watching.cancel()
    await asyncio.gather(watching, return_exceptions=True)
    return seen


async def watch_retreat(cell: Rail) -> None:
    """Nobody joins an arm in the zone; of two there one moves at a time, and none goes deeper."""
    before = {name: robot.x_m for name, robot in cell.robots.items()}
    inside = cell.inside()
    while True:
        await asyncio.sleep(TICK_S / 2)
        now = cell.inside()
        joined = set(now) - set(inside)
        assert not joined or len(now) == 1, f"{joined} joined {inside}"
        moved = {name for name in now if cell.robots[name].x_m != before[name]}
        if len(now) > 1:
            assert len(moved) <= 1, f"{moved} moved at once in the zone"
            assert cell.robots["a"].x_m <= 1.25
            assert cell.robots["b"].x_m >= 1.75
        inside, before = now, {name: robot.x_m for name, robot in cell.robots.items()}


async def lead_out(cell: Rail) -> None:
    """Everybody who is inside, in the order of the zone; the last one may go anywhere."""
    await asyncio.sleep(4 * TICK_S)
    for name, place_m in (("a", 0.0), ("b", 3.0), ("c", 3.0)):
        await cell.zoned[name].rearm()
        if name in cell.inside():
            await cell.zoned[name].move_linear(at(place_m), **SPEED)
    assert cell.inside() == []


@settings(deadline=None, max_examples=examples(60))
@given(orders)
def test_two_arms_in_the_zone_get_out_of_it_whatever_they_are_told(told: list[Order]) -> None:
    async def work() -> None:
        cell = rail(a=1.25, b=1.75, c=3.0, wait_s=1.0, retreat=("a", "b"))
        moves: dict[str, asyncio.Task[object]] = {}
        watching = asyncio.create_task(watch_retreat(cell))
        for order in told:
            await obey(cell, order, moves)
        ends = await asyncio.gather(*moves.values(), return_exceptions=True)
        assert all(not isinstance(end, Exception) or isinstance(end, CellError) for end in ends)
        await lead_out(cell)
        assert not watching.done() or watching.result() is None
        watching.cancel()
        await asyncio.gather(watching, return_exceptions=True)

    run(work())


@settings(deadline=None, max_examples=examples(60))
@given(orders)
def test_no_interleaving_lets_two_arms_share_the_zone(told: list[Order]) -> None:
    async def work() -> None:
        await play(rail(a=0.0, b=0.75, c=3.0, wait_s=1.0), told)

    run(work())


def test_the_orders_lead_through_the_zone() -> None:
    """The test above would find nothing if no arm ever came in."""

    async def work() -> None:
        told = [Order("a", 0, "move", 1.25), Order("b", 0, "move", 1.75), Order("a", 6, "move", 0)]
        assert await play(rail(a=0.0, b=0.75, c=3.0), told) > 3

    run(work())
