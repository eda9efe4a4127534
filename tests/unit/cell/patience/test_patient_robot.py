"""A move ends when its driver comes back, or when the arm has got nowhere for too long."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.cell.patience.patient_robot import (
    PatientRobot,
    PatientStreamingRobot,
    StandingTime,
    patient_robot,
)
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces import Robot, RobotState
from tests.contracts.inprocess.streaming_robot import InProcessStreamingRobot
from tests.unit.cell.robots import StillRobot

SOON = StandingTime(most_s=0.05, look_s=0.005)
HERE = RigidTransform.from_translation([1.0, 0.0, 1.0])

MOVES: dict[str, Callable[[Robot], Coroutine[Any, Any, RobotState]]] = {
    "joint": lambda robot: robot.move_joint(np.zeros(6), speed_ratio=0.1),
    "linear": lambda robot: robot.move_linear(HERE, speed_m_s=0.1, acceleration_m_s2=0.1),
    "step": lambda robot: robot.step(HERE, speed_m_s=0.1),
}


@pytest.fixture
async def arm() -> StillRobot:
    """Waits on its way until its road is free, and stands there."""
    return StillRobot("main", road_is_free=asyncio.Event())


@pytest.mark.parametrize("kind", MOVES)
async def test_an_arm_that_gets_nowhere(kind: str, arm: StillRobot) -> None:
    with pytest.raises(ReplyTimeout, match="main: its driver has not come back from a move"):
        await MOVES[kind](PatientRobot(arm, SOON))
    assert len(arm.moves) == arm.stops == 1


@pytest.mark.parametrize("kind", MOVES)
async def test_an_arm_that_arrives(kind: str) -> None:
    arm = StillRobot("main")
    await MOVES[kind](PatientRobot(arm, SOON))
    assert (len(arm.moves), arm.stops) == (1, 0)


@pytest.mark.parametrize(
    "creeps",
    [
        RigidTransform.from_translation([0.0, 0.0, 1e-4]),
        RigidTransform.from_rotation(Rotation.from_rotvec([0.0, 0.0, 1e-3])),
    ],
    ids=["straight", "turning"],
)
async def test_an_arm_that_creeps_has_all_the_time_it_wants(
    creeps: RigidTransform, arm: StillRobot
) -> None:
    assert arm.road_is_free is not None
    move = asyncio.create_task(MOVES["step"](PatientRobot(arm, SOON)))
    end_s = asyncio.get_running_loop().time() + 4 * SOON.most_s
    while asyncio.get_running_loop().time() < end_s:
        arm.flange = creeps * arm.flange
        await asyncio.sleep(SOON.look_s)
    assert not move.done()
    arm.road_is_free.set()
    await move


async def test_a_silent_arm_is_no_arm_that_moves(arm: StillRobot) -> None:
    arm.faults["state"] = LinkLost("cut")
    with pytest.raises(ReplyTimeout):
        await MOVES["joint"](PatientRobot(arm, SOON))


async def test_a_move_that_is_cancelled_leaves_the_driver(arm: StillRobot) -> None:
    move = asyncio.create_task(MOVES["joint"](PatientRobot(arm)))
    await arm.on_the_way.wait()
    move.cancel()
    with pytest.raises(asyncio.CancelledError):
        await move
    assert [other for other in asyncio.all_tasks() if "move_joint" in repr(other)] == []


async def test_each_kind_of_robot_stays_what_it_is() -> None:
    assert type(patient_robot(StillRobot("main"))) is PatientRobot
    assert type(patient_robot(InProcessStreamingRobot("arm"))) is PatientStreamingRobot
