"""Motions and bounds of the SIASUN driver against a scripted peer, record by record."""

import asyncio
from collections.abc import AsyncIterator

import numpy as np
import pytest

from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
    TargetOutOfBounds,
)
from cellctl.geometry.pose import pose_from_xyzabc, pose_to_xyzabc
from tests.rigs.wire.siasun_cell import HERE, LATCHED, MOVING, THERE, THERE_TEXT, Cell, running
from tests.rigs.wire.siasun_peer import POSE


@pytest.fixture
async def cell() -> AsyncIterator[Cell]:
    async with running() as cell:
        yield cell


async def test_state_is_si(cell: Cell) -> None:
    state = cell.robot.state()
    assert pose_to_xyzabc(state.base_T_flange) == pytest.approx(HERE)
    assert np.degrees(state.joints_rad) == pytest.approx([0, -45, 90, 0, 45, 0])
    assert state.ready


async def test_move(cell: Cell) -> None:
    move = cell.move()
    session = cell.cmd.session
    assert await cell.cmd.expect() == f"MOVL,{session},1,{THERE_TEXT},50.0000,200.0000"
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{THERE_TEXT}")
    cell.sta.stat(MOVING)
    await cell.report_until(move, pose=THERE_TEXT)
    state = await move
    assert pose_to_xyzabc(state.base_T_flange) == pytest.approx(THERE)  # type: ignore[attr-defined]
    assert not state.moving  # type: ignore[attr-defined]


async def test_the_time_from_a_command_to_its_acceptance_is_kept(cell: Cell) -> None:
    assert cell.robot.round_trips_s() == ()
    move = cell.move()
    await cell.cmd.expect()
    await asyncio.sleep(0.05)
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{THERE_TEXT}")
    await cell.report_until(move, pose=THERE_TEXT)
    await move
    (round_trip_s,) = cell.robot.round_trips_s()
    assert 0.045 < round_trip_s < 0.2


async def test_only_one_move_at_a_time(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    with pytest.raises(MotionRejected):
        await cell.move()
    cell.cmd.send("REJ,1,LIMIT")
    with pytest.raises(MotionRejected, match="joint limit"):
        await move


@pytest.mark.parametrize(
    ("reason", "fault"),
    [("REACH", MotionRejected), ("ESTOP", RobotNotReady), ("LATCHED", NotRearmed),
     ("ERROR", ControllerFault), ("LOAD", MotionRejected), ("NEWWORD", MotionRejected)],
)  # fmt: skip
async def test_rejections(cell: Cell, reason: str, fault: type[Exception]) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send(f"REJ,1,{reason}")
    with pytest.raises(fault, match=reason):
        await move


@pytest.mark.parametrize(
    ("flags", "fault"),
    [("MAN,0,1,0,0,0,100", RobotNotReady), ("REM,1,0,0,0,0,100", RobotNotReady),
     ("REM,0,0,0,0,0,100", RobotNotReady), (LATCHED, NotRearmed),
     ("REM,0,1,0,0,4001,100", ControllerFault)],
)  # fmt: skip
async def test_no_motion_is_sent_when_not_ready(
    cell: Cell, flags: str, fault: type[Exception]
) -> None:
    waiting = asyncio.create_task(cell.robot._state.wait(lambda _: True, 1.0))
    await asyncio.sleep(0)
    cell.sta.stat(flags)
    await waiting
    with pytest.raises(fault):
        await cell.move()


@pytest.mark.parametrize(
    "target",
    [[2000.1, 0, 900, 90, 0, 180], [1900, -500.1, 900, 90, 0, 180], [1900, 0, 799, 90, 0, 180]],
)
async def test_targets_out_of_the_workspace_are_not_sent(cell: Cell, target: list[float]) -> None:
    with pytest.raises(TargetOutOfBounds):
        await cell.move(target)
    allowed = cell.move()
    assert (await cell.cmd.expect()).split(",")[2] == "1"
    cell.cmd.send("REJ,1,LIMIT")
    with pytest.raises(MotionRejected):
        await allowed


async def test_speeds_and_steps_are_bounded(cell: Cell) -> None:
    robot, there = cell.robot, pose_from_xyzabc(THERE)
    with pytest.raises(TargetOutOfBounds, match="speed"):
        await robot.move_linear(there, speed_m_s=0.251, acceleration_m_s2=0.2)
    with pytest.raises(TargetOutOfBounds, match="speed"):
        await robot.move_linear(there, speed_m_s=float("nan"), acceleration_m_s2=0.2)
    with pytest.raises(TargetOutOfBounds, match="acceleration"):
        await robot.move_linear(there, speed_m_s=0.1, acceleration_m_s2=10.0)
    with pytest.raises(TargetOutOfBounds, match="step"):
        await robot.step(there, speed_m_s=0.001)
    turned = pose_from_xyzabc([*HERE[:3], 90.6, 0.0, 180.0])
    with pytest.raises(TargetOutOfBounds, match="turns"):
        await robot.step(turned, speed_m_s=0.001)
    with pytest.raises(TargetOutOfBounds, match="joint speed"):
        await robot.move_joint(np.zeros(6), speed_ratio=0.5)
    with pytest.raises(TargetOutOfBounds, match="joints"):
        await robot.move_joint(np.full(6, np.nan), speed_ratio=0.1)


async def test_a_motion_that_ends_elsewhere_latches(cell: Cell) -> None:
    move = cell.move()
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{POSE}")
    await cell.report_until(move)
    with pytest.raises(MotionAborted, match="away from the target"):
        await move
    with pytest.raises(NotRearmed):
        await cell.move()


async def test_joints_that_end_elsewhere_latch(cell: Cell) -> None:
    target_rad = np.radians([0.0, -45.0, 90.0, 0.0, 45.0, 0.5])
    move = asyncio.ensure_future(cell.robot.move_joint(target_rad, speed_ratio=0.1))
    await cell.cmd.expect()
    cell.cmd.send("ACK,1")
    cell.cmd.send(f"DONE,1,{POSE}")
    await cell.report_until(move)
    with pytest.raises(MotionAborted, match=r"-0.5\] deg away from the target"):
        await move
    with pytest.raises(NotRearmed):
        await cell.move()
