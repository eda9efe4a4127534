"""The way from the stand-off to the seat, and every way in which it ends early."""

import asyncio
from dataclasses import dataclass

import numpy as np
import pytest

from cellctl.errors.force import LiftOffHeld
from cellctl.errors.robot import ControllerFault
from cellctl.processes.antenna_module.faults.plugging import (
    PlugBentPin,
    PlugEarlyContact,
    PluggingError,
    PlugOverForce,
    PlugShortSeat,
    PlugSideForce,
)
from cellctl.processes.antenna_module.insertion.verdict import InsertionVerdict, judge_insertion
from cellctl.processes.antenna_module.pushing.back_out import back_out
from cellctl.processes.antenna_module.pushing.push_in import push_in
from tests.unit.processes.antenna_module.pushing.contact import (
    SOCKET,
    STAND_OFF_M,
    PlugArm,
    PlugWorld,
    Push,
    Wrench,
    good,
)

STEP_M = 0.1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Pushed:
    """A good plug that was pushed to its seat."""

    world: PlugWorld
    arm: PlugArm
    depth_m: float
    verdict: InsertionVerdict
    entry_m_s: float


@pytest.fixture(scope="module")
def pushed() -> Pushed:
    async def push_it() -> Pushed:
        world = PlugWorld()
        push = Push(world)
        async with push as attempt:
            depth_m = await push_in(attempt, STEP_M)
            verdict = judge_insertion(attempt.curve(), SOCKET).verdict
            return Pushed(world, push.arm, depth_m, verdict, attempt.limits.entry_m_s)

    return asyncio.run(push_it())


def test_a_good_plug_is_pushed_to_its_seat_and_no_farther(pushed: Pushed) -> None:
    assert pushed.depth_m == pytest.approx(2.5e-3, abs=0.06e-3)
    assert pushed.verdict is InsertionVerdict.SEATED
    assert pushed.world.felt()[2] < 24.0 + 20.0


def test_no_move_is_longer_than_a_step_and_fine_near_the_seat(pushed: Pushed) -> None:
    steps = np.diff(pushed.world.targets_mm)
    assert steps.max() <= 0.1 + 1e-6
    ends = np.array(pushed.world.targets_mm[1:])
    in_funnels = (ends > 0.001) & (ends < 0.499)
    assert steps[in_funnels].max() <= 0.03 + 1e-6
    near = ends > 2.36
    assert steps[near].max() <= 0.02 + 1e-6


def test_every_step_of_the_entry_is_as_slow_as_the_entry(pushed: Pushed) -> None:
    """Also the last one, which ends where the springs begin."""
    ends_mm = pushed.world.targets_mm[1:]
    assert len(ends_mm) == len(pushed.arm.speeds_m_s)
    for end_mm, speed_m_s in zip(ends_mm, pushed.arm.speeds_m_s, strict=True):
        assert (speed_m_s == pushed.entry_m_s) == (end_mm < 0.5 + 1e-6)


def pressing(begin_mm: float, n_per_mm: float, component: int = 2, lever_m: float = 0.0) -> Wrench:
    """Something that resists from a depth on, at a lever along y."""

    def wrench(depth_mm: float) -> tuple[float, ...]:
        felt = list(good(depth_mm))
        more_n = n_per_mm * max(0.0, depth_mm - begin_mm)
        felt[component] += more_n
        felt[3] += lever_m * more_n
        return tuple(felt)

    return wrench


@pytest.mark.parametrize(
    ("wrench", "fault"),
    [
        pytest.param(pressing(0.0, 400.0), PlugEarlyContact, id="on the face"),
        pytest.param(pressing(0.0, 115.0, lever_m=4.0e-3), PlugBentPin, id="one pin"),
        pytest.param(pressing(0.1, 50.0, component=0), PlugSideForce, id="side in the entry"),
        pytest.param(
            pressing(0.6, 10.0, component=1),
            PlugSideForce,
            id="side later",
            marks=pytest.mark.figures,
        ),
        pytest.param(pressing(1.0, 60.0), PlugOverForce, id="too much", marks=pytest.mark.figures),
        pytest.param(
            lambda depth_mm: (*good(min(depth_mm, 2.4))[:3], 0.0, 0.0, 0.0),
            PlugShortSeat,
            id="no seat",
            marks=pytest.mark.figures,
        ),
    ],
)
async def test_what_goes_wrong_is_named_before_anything_is_ruined(
    wrench: Wrench, fault: type[PluggingError]
) -> None:
    world = PlugWorld(wrench)
    push = Push(world)
    async with push as attempt:
        with pytest.raises(fault) as raised:
            await push_in(attempt, STEP_M)
        await back_out(attempt, raised.value, STAND_OFF_M)
    # The guard's stop, the second one of the guarded move, and that of backing out.
    assert push.arm.asked[0] == "stop"
    assert push.arm.asked[-1] == "rearm"
    assert world.depth_mm() == pytest.approx(-STAND_OFF_M * 1e3, abs=1e-6)
    assert not hasattr(raised.value, "__notes__")


async def test_a_turned_module_shows_in_the_entry() -> None:
    world = PlugWorld(
        lambda depth_mm: (*good(depth_mm)[:5], 0.1 * max(0.0, depth_mm)),
    )
    async with Push(world) as attempt:
        with pytest.raises(PlugSideForce):
            await push_in(attempt, STEP_M)
    assert world.depth_mm() < 0.3


async def test_a_plug_that_is_held_stops_the_way_out() -> None:
    holds = {"on": False}

    def wrench(depth_mm: float) -> tuple[float, ...]:
        if holds["on"] and depth_mm < 1.5:
            return (0.0, 0.0, -400.0 * (1.5 - depth_mm), 0.0, 0.0, 0.0)
        return pressing(1.0, 60.0)(depth_mm)

    world = PlugWorld(wrench)
    async with Push(world) as attempt:
        with pytest.raises(PlugOverForce) as raised:
            await push_in(attempt, STEP_M)
        holds["on"] = True
        await back_out(attempt, raised.value, STAND_OFF_M)
    assert any(LiftOffHeld.__name__ in note or "F529" in note for note in raised.value.__notes__)
    assert world.depth_mm() > 1.2


async def test_the_arm_stays_where_a_fault_of_its_own_has_left_it() -> None:
    world = PlugWorld()
    push = Push(world)
    async with push as attempt:
        await push_in(attempt, STEP_M)
        there = world.depth_mm()
        await back_out(attempt, ControllerFault("4711"), STAND_OFF_M)
    assert push.arm.asked == ["stop"]
    assert world.depth_mm() == there


async def test_a_robot_that_is_not_ready_is_not_moved_out() -> None:
    world = PlugWorld(pressing(0.0, 400.0))
    async with Push(world) as attempt:
        with pytest.raises(PlugEarlyContact) as raised:
            await push_in(attempt, STEP_M)
        there, world.ready = world.depth_mm(), False
        await back_out(attempt, raised.value, STAND_OFF_M)
    assert world.depth_mm() == there


async def test_noise_on_what_presses_does_not_stop_the_way_out() -> None:
    """A mean is what half of the samples are above."""
    world = PlugWorld(pressing(1.0, 60.0))
    push = Push(world)
    async with push as attempt:
        with pytest.raises(PlugOverForce) as raised:
            await push_in(attempt, STEP_M)
        pressed_n = 200.0
        world.wrench = lambda depth_mm: (0.0, 0.0, pressed_n, 0.0, 0.0, 0.0)
        world.go(world.flange)
        await back_out(attempt, raised.value, STAND_OFF_M)
    assert push.guard.limits[-1].filtered[2] > pressed_n + 1.0
