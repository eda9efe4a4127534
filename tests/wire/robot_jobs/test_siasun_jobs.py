"""What only the shipped job files show: the permit loop, alarms, and their own refusals."""

import asyncio
from collections.abc import AsyncIterator

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.errors.robot import ControllerFault, MotionAborted, MotionRejected, NotRearmed
from cellctl.interfaces.robot import RobotState
from tests.rigs.wire.job_rig import JobRig, job_rig


@pytest.fixture
async def rig() -> AsyncIterator[JobRig]:
    async with job_rig() as rig:
        await rig.connect()
        yield rig


def move(rig: JobRig, dz_mm: float = 60.0) -> "asyncio.Task[RobotState]":
    here = rig.robot.state().base_T_flange
    target = RigidTransform.from_translation([0.0, 0.0, dz_mm / 1000]) * here
    return asyncio.create_task(rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0))


async def until_moving(rig: JobRig) -> None:
    await rig.robot._state.wait(lambda status: status.moving, 2.0)


async def test_the_contact_of_the_pc_stops_a_motion_and_latches(rig: JobRig) -> None:
    moving = move(rig)
    await until_moving(rig)
    rig.controller.contact_closed = lambda: False
    async with asyncio.timeout(2.0):
        with pytest.raises(MotionAborted, match="STOP"):
            await moving
    assert not rig.controller.moving()
    rig.controller.contact_closed = lambda: True
    await rig.robot._state.wait(lambda status: status.latched, 1.0)
    await rig.robot.rearm()
    await move(rig, 1.0)


async def test_the_contact_stops_beside_background_jobs_that_hang(rig: JobRig) -> None:
    moving = move(rig)
    await until_moving(rig)
    rig.controller.faults.inject("frozen_stat")
    rig.controller.contact_closed = lambda: False
    async with asyncio.timeout(2.0):
        with pytest.raises(CellError):
            await moving
        while rig.controller.moving():  # noqa: ASYNC110  the arm has no event
            await asyncio.sleep(0.01)


async def test_a_pc_that_comes_late_finds_no_latch() -> None:
    async with job_rig() as rig:
        rig.controller.start()
        # This is longer than the dead man's time: nobody is at the ports that the jobs call.
        await asyncio.sleep(0.6)
        await rig.robot.connect()
        await rig.robot._state.wait(lambda status: not status.latched, 0.5)
        await move(rig, 1.0)


async def test_an_open_loop_refuses_the_release(rig: JobRig) -> None:
    await rig.robot.stop()
    rig.controller.contact_closed = lambda: False
    with pytest.raises(CellError):
        await rig.robot.rearm()
    assert rig.robot.state().stop_latched


async def test_a_target_out_of_reach_is_an_alarm_that_ends_the_main_job() -> None:
    known = {"4100": {"text": "Target out of range", "remedy": "Acknowledge, start SJLMAIN."}}
    far_mm = (9000.0, 900.0, 9000.0)
    async with job_rig(workspace_max_mm=far_mm, controller_errors=known) as rig:
        await rig.connect()
        async with asyncio.timeout(3.0):
            # The link goes with the main job; what its controller shows is told in its place.
            with pytest.raises(ControllerFault, match="4100, Target out of range; Acknowledge"):
                await move(rig, 5000.0)
        assert "REACH" in rig.controller.alarm
        await rig.robot._state.wait(lambda status: status.error_code != 0, 1.0)
        rig.controller.acknowledge()
        await rig.robot._state.wait(lambda status: status.error_code == 0, 1.0)
        async with asyncio.timeout(3.0):
            while not rig.robot._command.channel.connected:  # noqa: ASYNC110  no event for it
                await asyncio.sleep(0.01)
        await rig.robot.rearm()
        await move(rig, 1.0)


async def test_an_error_of_the_controller_ends_a_motion(rig: JobRig) -> None:
    moving = move(rig)
    await until_moving(rig)
    rig.controller.faults.inject("vendor_error", code=17)
    async with asyncio.timeout(2.0):
        with pytest.raises(ControllerFault):
            await moving


async def test_the_job_refuses_a_long_step_by_itself(rig: JobRig) -> None:
    here = rig.robot.state().base_T_flange
    target = RigidTransform.from_translation([0.0, 0.0, 0.0006]) * here
    xyzabc = rig.robot._command.written(target)
    with pytest.raises(MotionRejected, match="STEP"):
        await rig.robot._command.run(
            lambda session, seq: rig.robot._command.words.step(session, seq, xyzabc, 5.0), 1.0
        )


async def test_losing_only_the_commands_stops_the_arm(rig: JobRig) -> None:
    """The main job hears nothing while it moves the arm; the driver stops it over STA."""
    moving = move(rig)
    await until_moving(rig)
    rig.wires["CMD"].reset()
    with pytest.raises(LinkError):
        await moving
    async with asyncio.timeout(1.0):
        while rig.controller.moving():  # noqa: ASYNC110  the arm has no event
            await asyncio.sleep(0.01)
    assert rig.arm.cut_short


async def test_a_release_is_refused_while_the_arm_moves(rig: JobRig) -> None:
    """Another job moves it, of which this PC knows only that the arm is not still."""
    rig.turn()
    await until_moving(rig)
    with pytest.raises(NotRearmed, match="LATCHED"):
        await rig.robot.rearm()
