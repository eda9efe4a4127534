"""Faults of a controller that runs the shipped jobs, as far as a controller could have them."""

import asyncio
from collections.abc import AsyncIterator

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.errors.robot import ControllerFault, MotionAborted
from cellctl.interfaces.robot import RobotState
from drivers.robot.siasun.codec.records import Status
from tests.rigs.wire.job_rig import JobRig, job_rig


@pytest.fixture
async def rig() -> AsyncIterator[JobRig]:
    async with job_rig(stop_timeout_s=2.0) as rig:
        await rig.connect()
        yield rig


def move(rig: JobRig) -> "asyncio.Task[RobotState]":
    up = RigidTransform.from_translation([0.0, 0.0, 0.06])
    target = up * rig.robot.state().base_T_flange
    return asyncio.create_task(rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0))


async def moving(rig: JobRig) -> "asyncio.Task[RobotState]":
    job = move(rig)
    await rig.robot._state.wait(lambda status: status.moving, 2.0)
    return job


async def test_a_stop_that_is_overheard_once_is_asked_for_again(rig: JobRig) -> None:
    job = await moving(rig)
    rig.controller.faults.inject("ignore_stop", count=1)
    await rig.robot.stop()
    with pytest.raises(MotionAborted):
        await job
    assert rig.arm.cut_short
    assert rig.controller.faults.names() == []


async def between_its_clocks(rig: JobRig) -> None:
    """The job stops its clock and starts it anew in two statements; a jump between them is lost, as
    it would be on a controller. It is far from both while it waits for what the PC sends."""
    task = rig.controller.tasks["SJLSTA"]
    while task.program.statements[task._place - 1].word != "TCPRECV":  # noqa: ASYNC110  no event
        await asyncio.sleep(0)


async def test_a_clock_that_jumps_shows_in_the_reports(rig: JobRig) -> None:
    """The dead man reads the same clock, and a heartbeat in the same round saves the motion."""
    reported: list[int] = []

    def note(status: Status) -> bool:
        reported.append(status.robot_ms)
        return True

    await rig.robot._state.wait(note, 1.0)
    await between_its_clocks(rig)
    rig.controller.faults.inject("clock_jump", jump_ms=5000)
    await rig.robot._state.wait(lambda status: status.robot_ms > reported[0] + 5000, 1.0)
    assert not rig.robot.state().moving


async def test_a_slow_stop_takes_its_time(rig: JobRig) -> None:
    job = await moving(rig)
    rig.controller.faults.inject("stop_latency", latency_s=0.8)
    asked_s = asyncio.get_running_loop().time()
    await rig.robot.stop()
    assert asyncio.get_running_loop().time() - asked_s > 0.7
    with pytest.raises(MotionAborted):
        await job


async def test_a_rejected_motion_is_an_alarm_until_somebody_acknowledges(rig: JobRig) -> None:
    rig.controller.faults.inject("reject", count=1, reason="LIMIT")
    with pytest.raises(ControllerFault, match="4100"):
        await move(rig)
    assert "LIMIT" in rig.controller.alarm
    rig.controller.acknowledge()
    async with asyncio.timeout(5.0):
        while True:
            try:
                await rig.robot.rearm()
                break
            except CellError:
                await asyncio.sleep(0.05)
    assert rig.controller.alarm == ""


async def test_streams_have_no_faults_where_there_are_no_streams(rig: JobRig) -> None:
    with pytest.raises(ValueError, match="set_lost"):
        rig.controller.faults.inject("set_lost")


async def test_channels_are_open_once_the_pc_has_answered() -> None:
    async with job_rig() as rig:
        assert rig.controller.open_channels == []
        await rig.connect()
        assert rig.controller.open_channels == ["CMD", "STA"]
