"""A guarded move that ends early: whether the force was the reason, or the robot itself."""

import asyncio
from typing import Any

import pytest

from cellctl.cell.guarded_motion.guarded_moves import guarded
from cellctl.errors.robot import MotionAborted
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.interfaces import RobotMode, RobotState
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot

SHAKEN = GuardTrip(TripReason.RAW_LIMIT, 1.0, "Fz -33.62 N, limit 32.00 N", 2, -33.62)


def braked_robot(**looks: Any) -> StillRobot:
    return StillRobot("main", faults={"move": MotionAborted("main: ESTOP")}, looks=looks)


async def move(robot: StillRobot, guard: TinyGuard) -> GuardTrip | None:
    motion = robot.move_linear(robot.flange, speed_m_s=0.005, acceleration_m_s2=0.2)
    return await guarded(robot, guard, motion)


@pytest.mark.parametrize(
    "looks",
    [
        {"emergency_stop": True},
        {"drives_on": False},
        {"mode": RobotMode.MANUAL},
        {"error_code": 17},
    ],
)
async def test_the_brakes_of_the_robot_are_no_contact(looks: dict[str, Any]) -> None:
    """They shake the payload beyond the limits of the guard."""
    robot = braked_robot(**looks)
    with pytest.raises(MotionAborted) as caught:
        await move(robot, TinyGuard(trip=SHAKEN))
    assert any(SHAKEN.detail in note for note in caught.value.__notes__)
    assert robot.stops > 0


async def test_a_robot_that_was_stopped_by_the_guard_met_something() -> None:
    robot = braked_robot(stop_latched=True)
    assert await move(robot, TinyGuard(trip=SHAKEN)) is SHAKEN
    assert robot.stops > 0


async def test_without_a_trip_the_robots_own_fault_stands() -> None:
    with pytest.raises(MotionAborted):
        await move(braked_robot(emergency_stop=True), TinyGuard())


async def test_an_arm_that_arrives_as_the_guard_trips_is_stopped_by_the_daemon_too() -> None:
    robot, guard = StillRobot("main"), TinyGuard()

    async def arrives() -> RobotState:
        await asyncio.sleep(0)
        guard.trip = SHAKEN
        return robot.state()

    assert await guarded(robot, guard, arrives()) is SHAKEN
    assert robot.stops == 1, "or its latch would be one that nobody has asked for"
