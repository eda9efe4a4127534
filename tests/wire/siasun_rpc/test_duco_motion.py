"""What the controller of a collaborative arm says, and what becomes of it."""

import asyncio

import numpy as np
import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, StaleData, VersionMismatch
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
    StopFailed,
    StreamNotOffered,
    TargetOutOfBounds,
    WayNotReached,
)
from cellctl.interfaces.robot import RobotMode
from drivers.robot.siasun_rpc import faults
from drivers.robot.siasun_rpc.features import features
from drivers.robot.siasun_rpc.vendor import SafetyState, TaskState, name
from tests.rigs.shipped import shipped_cell
from tests.rigs.wire.duco_rig import duco_rig
from tests.wire.siasun_rpc.duco_moves import begun, move, rearm, stands, up

DH = shipped_cell("deck.toml").robots["main"].settings["dh"]
"""D-H lengths of the fake arm."""

# --- ends of a task


@pytest.mark.parametrize(
    ("state", "fault"),
    [
        (TaskState.PAUSED, MotionAborted),
        (TaskState.STOPPED, MotionAborted),
        (TaskState.INTERRUPTED, MotionAborted),
        (TaskState.ERROR, ControllerFault),
        (TaskState.ILLEGAL, MotionRejected),
        (TaskState.PARAMETERS, MotionRejected),
        (42, MotionAborted),
    ],
)
async def test_a_task_that_does_not_finish(state: int, fault: type[CellError]) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        rig.logic.faults.inject("task_end", count=1, state=float(state))
        with pytest.raises(fault, match="injected end"):
            await move(rig, 3.0)
        if fault is MotionRejected:
            assert not rig.robot.state().stop_latched
        else:
            with pytest.raises(NotRearmed):
                await move(rig, 3.0)
        await rearm(rig)
        await move(rig, 3.0)


async def test_a_paused_task_is_stopped_so_that_nothing_can_be_resumed() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        rig.logic.faults.inject("task_end", count=1, state=float(TaskState.PAUSED))
        with pytest.raises(MotionAborted, match="paused"):
            await move(rig, 3.0)
        assert rig.logic.stops >= 1


async def test_a_call_without_a_task() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        rig.logic.faults.inject("minus_one", count=1)
        with pytest.raises(MotionRejected, match="-1"):
            await move(rig, 3.0)
        await move(rig, 3.0)


async def test_out_of_reach_is_the_controllers_to_say() -> None:
    async with duco_rig(workspace_max_mm=(5000.0, 900.0, 4000.0)) as rig:
        await rig.robot.connect()
        with pytest.raises(MotionRejected, match="REACH"):
            await move(rig, 2500.0)


def test_every_end_has_words() -> None:
    for state in TaskState:
        text = str(faults.ended("arm", state, ["E1", "E2", "E3", "E4"]))
        assert f"({state.value})" in text
        assert "E1 | E2 | E3" in text
        assert "E4" not in text
    assert name(SafetyState, 9) == "stop 0 (9)"
    assert name(SafetyState, 77) == "unknown (77)"


# --- states that are shown and never changed


@pytest.mark.parametrize(
    ("wrong", "fault", "words"),
    [
        ("emergency_stop", RobotNotReady, "stop 0"),
        ("manual_mode", RobotNotReady, "manual"),
        ("disabled", RobotNotReady, "disabled"),
        ("collision", RobotNotReady, "axis 3"),
        ("simulation", RobotNotReady, "simulates"),
        ("vendor_error", ControllerFault, "1001"),
    ],
)
async def test_not_ready(wrong: str, fault: type[CellError], words: str) -> None:
    async with duco_rig() as rig:
        rig.logic.faults.inject(wrong)
        await rig.robot.connect()
        with pytest.raises(fault, match=words):
            await move(rig, 3.0)
        assert rig.logic.motions == 0


async def test_states_are_shown() -> None:
    async with duco_rig() as rig:
        for wrong in ("emergency_stop", "manual_mode", "disabled", "override", "vendor_error"):
            rig.logic.faults.inject(wrong)
        await rig.robot.connect()
        state = rig.robot.state()
        assert state.emergency_stop
        assert state.mode is RobotMode.MANUAL
        assert not state.drives_on
        assert state.speed_override_ratio == 0.5
        assert state.error_code == 1001
        assert not state.ready


@pytest.mark.parametrize("wrong", ["emergency_stop", "manual_mode", "vendor_error"])
async def test_a_state_that_changes_during_a_motion_ends_it(wrong: str) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        rig.logic.faults.inject(wrong)
        with pytest.raises((MotionAborted, RobotNotReady, ControllerFault)):
            async with asyncio.timeout(3.0):
                await moving
        assert not rig.logic.moving()
        rig.logic.faults.clear()
        with pytest.raises((NotRearmed, ControllerFault)):
            await move(rig, 1.0)


async def test_a_task_that_finishes_while_the_arm_moves_is_not_believed() -> None:
    async with duco_rig(stop_timeout_s=1.0) as rig:
        await rig.robot.connect()
        slow = rig.robot.move_linear(up(rig, 80.0), speed_m_s=0.02, acceleration_m_s2=1.0)
        moving = asyncio.create_task(slow)
        async with asyncio.timeout(2.0):
            while not rig.logic.tasks.running:
                await asyncio.wait({moving}, timeout=0.005)
        rig.logic.tasks.end(TaskState.FINISHED)
        with pytest.raises(StaleData):
            await moving
        assert not rig.logic.moving()
        with pytest.raises(NotRearmed):
            await move(rig, 1.0)


# --- frames, units and the order of angles


@pytest.mark.parametrize("euler", ["moving-xyz", "rotation-vector"])
async def test_a_wrong_order_of_angles_is_found_by_the_kinematics(euler: str) -> None:
    async with duco_rig(euler=euler, dh=DH) as rig:
        with pytest.raises(VersionMismatch, match="order of angles"):
            await rig.robot.connect()
        with pytest.raises(LinkError):
            rig.robot.state()


async def test_the_right_order_of_angles_fits_the_kinematics() -> None:
    async with duco_rig(euler="moving-xyz", dh=DH) as rig:
        rig.logic.faults.inject("euler")
        await rig.robot.connect()
        target = up(rig, 3.0)
        state = await rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
        assert state.distance_to(target)[1] < 1e-6


async def test_a_joint_move_whose_way_leaves_the_box_is_not_sent() -> None:
    async with duco_rig(dh=DH) as rig:
        await rig.robot.connect()
        target_rad = rig.robot.state().joints_rad + np.array([1.5, 0.0, 0.0, 0.0, 0.0, 0.0])
        with pytest.raises(TargetOutOfBounds, match="on the way"):
            await rig.robot.move_joint(target_rad, speed_ratio=0.1)
        assert rig.logic.motions == 0


async def test_a_straight_move_that_the_arm_cannot_follow_is_not_sent() -> None:
    async with duco_rig(dh=DH, joints_min_deg=(-360.0, -52.77, *(-360.0,) * 4)) as rig:
        await rig.robot.connect()
        with pytest.raises(WayNotReached, match="of the way"):
            await move(rig, 50.0)
        with pytest.raises(WayNotReached, match="of the way"):
            await rig.robot.step(up(rig, 0.4), speed_m_s=0.01)
        assert rig.logic.motions == 0
        await move(rig, -3.0)


async def test_a_frame_that_does_not_exist() -> None:
    async with duco_rig(tool="gripper") as rig:
        with pytest.raises(CellError, match="six finite numbers"):
            await rig.robot.connect()


async def test_the_times_of_the_questions_for_its_state_are_kept() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        before = len(rig.robot.round_trips_s())
        await asyncio.sleep(0.2)
        times_s = rig.robot.round_trips_s()
        assert len(times_s) > before
        assert all(0.0 < time_s < 0.5 for time_s in times_s)


async def test_a_joint_move_is_in_percent_and_radians() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        target_rad = rig.robot.state().joints_rad + np.array([0.0, 0.01, 0.0, 0.0, 0.0, 0.0])
        state = await rig.robot.move_joint(target_rad, speed_ratio=0.3)
        assert np.allclose(state.joints_rad, target_rad, atol=1e-9)


# --- stopping


async def test_a_stop_that_is_ignored_ends_all_signs_of_life() -> None:
    async with duco_rig(stop_timeout_s=0.8) as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        rig.logic.faults.inject("stop_ignored")
        with pytest.raises(StopFailed):
            await rig.robot.stop()
        with pytest.raises((MotionAborted, StopFailed)):
            await moving
        assert rig.logic.stops >= 2
        with pytest.raises(CellError):
            rig.robot.state()
        rig.logic.faults.clear("stop_ignored")
        await stands(rig)


@pytest.mark.parametrize("cancelled", [True, False])
async def test_nothing_moves_after_a_stop_that_has_overtaken_a_move(*, cancelled: bool) -> None:
    """Both go over connections of their own, and the controller has no latch."""
    async with duco_rig() as rig:
        await rig.robot.connect()
        rig.logic.faults.inject("motion_late", count=1, delay_s=0.2)
        moving = move(rig, 80.0)
        await asyncio.wait({moving}, timeout=0.05)
        if cancelled:
            moving.cancel()
        await rig.robot.stop()
        confirmed = rig.robot.state().base_T_flange
        with pytest.raises((CellError, asyncio.CancelledError)):
            await moving
        await asyncio.sleep(0.3)
        assert rig.logic.motions == 1, "the controller has taken it"
        travelled_m, _ = rig.robot.state().distance_to(confirmed)
        assert travelled_m < 1e-5


async def test_a_stop_is_not_confirmed_while_a_move_is_on_its_way() -> None:
    async with duco_rig(stop_timeout_s=0.4) as rig:
        await rig.robot.connect()
        rig.logic.faults.inject("motion_late", count=1, delay_s=2.0)
        moving = move(rig, 80.0)
        await asyncio.wait({moving}, timeout=0.05)
        with pytest.raises(StopFailed, match="has not answered a move"):
            await rig.robot.stop()
        with pytest.raises(CellError):
            await moving


async def test_a_motion_without_an_end_is_stopped() -> None:
    async with duco_rig(move_timeout_s=0.2) as rig:
        await rig.robot.connect()
        with pytest.raises(CellError, match="no end"):
            await move(rig, 80.0)
        assert not rig.logic.moving()
        with pytest.raises(NotRearmed):
            await move(rig, 1.0)


# --- versions


@pytest.mark.parametrize(
    ("version", "streams"),
    [("V3.8.4", True), ("Core 4.3", True), ("3.8.3", False), ("3.2.0", False), ("beta", False)],
)
def test_versions(version: str, streams: bool) -> None:
    assert features(version).streams is streams


def test_a_controller_that_cannot_name_its_version_does_not_stream() -> None:
    assert not features(None).streams


def test_too_old() -> None:
    with pytest.raises(VersionMismatch, match="at least"):
        features("V2.9.1")


async def test_an_unknown_version_moves_and_does_not_stream() -> None:
    async with duco_rig() as rig:
        rig.logic.faults.inject("unknown")
        await rig.robot.connect()
        await move(rig, 1.0)
        with pytest.raises(StreamNotOffered):
            rig.robot.stream_offer()


async def test_without_a_measured_period_nothing_is_streamed() -> None:
    async with duco_rig(servo_period_ms=None) as rig:
        await rig.robot.connect()
        with pytest.raises(StreamNotOffered, match="servo_period_ms"):
            rig.robot.stream_offer()


# --- the fake is as bad as the real one may be


async def test_without_heartbeats_the_fake_moves_on() -> None:
    async with duco_rig() as rig:
        rig.logic.move_joint([0.5, *rig.logic.joints()[1:]], 10.0)
        await asyncio.sleep(0.4)  # longer than any heartbeat
        assert rig.logic.moving()


async def test_the_fake_obeys_again_after_a_stop() -> None:
    async with duco_rig() as rig:
        rig.logic.move_joint([0.5, *rig.logic.joints()[1:]], 10.0)
        rig.logic.stop()
        await stands(rig)
        rig.logic.move_joint([0.5, *rig.logic.joints()[1:]], 10.0)
        assert rig.logic.moving()
