"""The SIASUN driver against the fake controller: faults of the wire and of the controller."""

import asyncio
import re

import numpy as np
import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkLost, ProtocolViolation, ReplyTimeout, VersionMismatch
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
)
from fakes.scenario_file.sections import Channel
from tests.rigs.wire.any_rig import AnyRig, Make, above, move, rearm, until_moving, within
from tests.rigs.wire.sjl_rig import Rig, sjl_rig


async def test_moves_arrive(rig: AnyRig) -> None:
    target = above(rig, 10.0)
    state = await within(3.0, move(rig, 10.0))
    distance_m, angle_rad = state.distance_to(target)
    assert distance_m < 1e-5
    assert angle_rad < 1e-5
    joints_rad = state.joints_rad + np.radians([0, 0, 0, 0, 0, 1.0])
    state = await rig.robot.move_joint(joints_rad, speed_ratio=1.0)
    assert state.joints_rad == pytest.approx(joints_rad, abs=1e-6)
    state = await rig.robot.step(above(rig, -0.4), speed_m_s=0.01)
    assert not state.moving


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_split_packets_change_nothing(rig: AnyRig, direction: str) -> None:
    for wire in rig.wires.values():
        getattr(wire, direction).split = True
    await within(5.0, move(rig, 5.0))


async def test_merged_reports_change_nothing(rig: AnyRig) -> None:
    rig.wires["STA"].forth.merge_bytes = 500
    await within(5.0, move(rig, 5.0))


async def test_a_late_answer_is_waited_for(rig: AnyRig) -> None:
    rig.wires["CMD"].forth.delay_s = 0.1
    await within(5.0, move(rig, 5.0))


@pytest.mark.parametrize("channel", ["CMD", "STA"])
async def test_reset_fails_the_move_at_once_and_never_resumes(
    rig: AnyRig, channel: Channel
) -> None:
    moving = move(rig)
    await until_moving(rig)
    rig.wires[channel].reset()
    with pytest.raises(LinkLost):
        await within(0.1, moving)
    await rearm(rig)
    assert not rig.robot.state().moving
    stopped_at = rig.robot.state().base_T_flange
    if isinstance(rig, Rig):  # a job cannot ask for a limit before it moves
        rig.controller.faults.inject("reject", count=1, reason="LIMIT")
        with pytest.raises(MotionRejected):
            await move(rig)
    assert rig.robot.state().distance_to(stopped_at)[0] < 1e-6
    await within(5.0, move(rig, 5.0))


async def test_a_digit_that_changes_on_the_way_in_is_seen(rig: AnyRig) -> None:
    moving = move(rig)
    await until_moving(rig)
    rig.wires["STA"].forth.corrupt_in = 30
    with pytest.raises(ProtocolViolation):
        await within(0.5, moving)
    with pytest.raises(CellError):
        await move(rig)
    await rearm(rig)


async def test_a_digit_that_changes_on_the_way_out_never_moves_the_arm(rig: AnyRig) -> None:
    before = rig.robot.state().base_T_flange
    rig.wires["CMD"].back.corrupt_in = 30
    with pytest.raises(LinkLost):
        await within(1.0, move(rig))
    await rearm(rig)
    assert rig.robot.state().distance_to(before)[0] < 1e-6


@pytest.mark.parametrize("direction", ["forth", "back"])
@pytest.mark.parametrize("channel", ["CMD", "STA"])
async def test_half_open(rig: AnyRig, channel: Channel, direction: str) -> None:
    """Nothing arrives any more, but the socket stands: the move ends in bounded time."""
    wire = rig.wires[channel]
    target = above(rig, 100.0)
    getattr(wire, direction).blocked = True
    with pytest.raises((LinkLost, ReplyTimeout, MotionAborted)):
        await within(4.0, move(rig, 100.0, 0.04))
    getattr(wire, direction).blocked = False
    wire.reset()
    await rearm(rig)
    assert not rig.arm.moving(rig.controller._clock())
    assert rig.robot.state().distance_to(target)[0] > 0.02
    await within(5.0, move(rig, 5.0))


async def test_lost_bytes_are_a_violation(rig: AnyRig) -> None:
    rig.wires["STA"].forth.drop_bytes = 10
    moving = move(rig)
    with pytest.raises((ProtocolViolation, NotRearmed, LinkLost)):
        await within(1.0, moving)
    await rearm(rig)


async def test_cancelling_stops_the_arm(rig: AnyRig) -> None:
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    moving.cancel()
    with pytest.raises(asyncio.CancelledError):
        await within(2.0, moving)
    assert not rig.arm.moving(rig.controller._clock())
    assert rig.arm.cut_short
    with pytest.raises(NotRearmed):
        await move(rig)
    await rig.robot.rearm()
    await within(5.0, move(rig, 5.0))


async def test_an_overheard_stop_is_repeated(rig: AnyRig) -> None:
    rig.controller.faults.inject("ignore_stop", count=1)
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    await within(2.0, rig.robot.stop())
    assert not rig.arm.moving(rig.controller._clock())
    with pytest.raises(MotionAborted):
        await moving


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("emergency_stop_mid_move", MotionAborted), ("abort", ControllerFault)],
)
async def test_the_controller_aborts(rig: AnyRig, fault: str, expected: type[CellError]) -> None:
    rig.controller.faults.inject(fault, count=1, after_s=0.1)
    with pytest.raises(expected):
        await within(3.0, move(rig, 100.0, 0.05))
    rig.controller.faults.clear()
    with pytest.raises(NotRearmed):
        await move(rig)
    await rearm(rig)


@pytest.mark.parametrize(
    ("fault", "expected"),
    [("manual_mode", RobotNotReady), ("automatic_mode", RobotNotReady),
     ("drives_off", RobotNotReady), ("vendor_error", ControllerFault)],
)  # fmt: skip
async def test_not_ready(rig: AnyRig, fault: str, expected: type[CellError]) -> None:
    rig.controller.faults.inject(fault)
    await rig.robot._state.wait(lambda status: True, 1.0)
    with pytest.raises(expected):
        await move(rig)


async def test_never_done(make: Make) -> None:
    async with make(move_timeout_s=0.4) as rig:
        await rig.connect()
        rig.controller.faults.inject("never_done", count=1)
        with pytest.raises(ReplyTimeout):
            await within(3.0, move(rig, 1.0))


async def test_frozen_reports_count_as_silence(rig: AnyRig) -> None:
    rig.controller.faults.inject("frozen_stat")
    with pytest.raises(LinkLost):
        await within(3.0, move(rig, 100.0, 0.05))


async def test_a_clock_that_jumps_is_no_fault(rig: AnyRig) -> None:
    rig.controller.faults.inject("clock_jump", jump_ms=1e6)
    await within(3.0, move(rig, 5.0))


async def test_reboot_of_the_controller(rig: AnyRig) -> None:
    moving = move(rig)
    await until_moving(rig)
    await rig.controller.reboot()
    with pytest.raises(LinkLost):
        await within(0.5, moving)
    await rearm(rig)
    await within(5.0, move(rig, 5.0))


@pytest.mark.parametrize("fault", ["wrong_version", "wrong_euler", "wrong_unit", "wrong_name"])
async def test_a_wrong_hello_is_refused(fault: str, make: Make) -> None:
    async with make() as rig:
        rig.controller.faults.inject(fault)
        with pytest.raises(VersionMismatch):
            await rig.connect()


async def test_a_dead_event_loop_lets_the_dead_man_stop_the_arm(rig: AnyRig) -> None:
    """The daemon hangs: heartbeats stay away although the sockets stand."""
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    rig.wires["STA"].back.blocked = True
    with pytest.raises(MotionAborted, match="DEADMAN"):
        await within(2.0, moving)


async def test_a_latch_by_the_dead_man_tells_that_this_pc_has_paused() -> None:
    words = r"stop latch is set; this PC has sent no heartbeat for 0\.\d+ s, its dead man is 0\.3 s"
    async with sjl_rig(silence_s=3.0) as rig:
        await rig.connect()
        await rearm(rig)
        # The PC seems to stand still: heartbeats stay away, and come again.
        rig.robot._state._cancel_timer()
        await rig.robot._state.wait(lambda status: status.latched, 2.0)
        await asyncio.sleep(0.1)
        rig.robot._state._beat()
        # Before any motion asks: whoever watches an arm that stands tells it.
        assert re.search(words, f"stop latch is set; {rig.robot.state().unasked_latch}")
        with pytest.raises(NotRearmed, match=words):
            await move(rig, 1.0, 0.05)
        await rearm(rig)
        assert not rig.robot.state().unasked_latch
        await within(5.0, move(rig, 1.0, 0.05))


async def test_a_stop_that_was_asked_for_is_no_latch_of_nobody(rig: AnyRig) -> None:
    await rig.robot.stop()
    state = rig.robot.state()
    assert state.stop_latched
    assert not state.unasked_latch


async def test_a_link_that_is_lost_for_a_moment_leaves_a_latch_that_says_so(rig: AnyRig) -> None:
    rig.wires["CMD"].reset()
    await rig.robot._state.wait(lambda status: status.latched, 2.0)
    await within(2.0, rig.robot._command.channel.wait_connected())
    assert "CMD" in rig.robot.state().unasked_latch
