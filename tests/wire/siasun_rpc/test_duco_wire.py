"""The driver of collaborative arms on a line that splits, merges, delays, corrupts and goes silent.

Whatever the line does, a motion ends at its target or with a fault of the link, and the arm stands.
"""

import asyncio

import numpy as np
import pytest

from cellctl.errors.link import (
    ConnectTimeout,
    LinkError,
    ProtocolViolation,
    StaleData,
)
from cellctl.errors.robot import NotRearmed
from tests.rigs.wire.duco_rig import duco_rig
from tests.rigs.wire.ports import free_port
from tests.wire.siasun_rpc.duco_moves import begun, move, rearm, stands, up


@pytest.mark.parametrize("way", ["split", "merged", "delayed"])
async def test_a_bad_but_honest_line(way: str) -> None:
    async with duco_rig() as rig:
        for direction in (rig.rpc.forth, rig.rpc.back, rig.frames.back):
            direction.split = way == "split"
            direction.delay_s = 0.02 if way == "delayed" else 0.0
        rig.frames.back.merge_bytes = 2 * 1468 if way == "merged" else 0
        await rig.robot.connect()
        target = up(rig, 3.0)
        state = await rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
        assert state.distance_to(target)[0] < 1e-6


@pytest.mark.parametrize("byte", [0, 3, 7, 12, 21, 30, 60])
async def test_a_corrupt_reply_ends_in_a_fault_or_in_the_truth(byte: int) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        rig.rpc.back.corrupt_in = byte
        async with asyncio.timeout(4.0):
            try:
                state = await moving
            except (LinkError, NotRearmed):
                await stands(rig)
                await rearm(rig)
                assert rig.logic.motions == 1
            else:
                # The lowest bit of a number has changed, and the next answer was right again.
                flange = rig.arm.encoder_pose(rig.logic.clock())
                assert state.distance_to(flange)[0] < 1e-6


async def test_a_corrupt_call_is_not_carried_out_as_another_motion() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        before = rig.arm.encoder_pose(rig.logic.clock())
        rig.rpc.forth.corrupt_in = 3
        with pytest.raises((LinkError, NotRearmed)):
            await move(rig, 3.0)
        await stands(rig)
        after = rig.arm.encoder_pose(rig.logic.clock())
        assert abs(after.translation - before.translation).max() < 0.0031


async def test_a_silent_controller_is_found_out_and_the_arm_stops() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        rig.logic.faults.inject("silent")
        with pytest.raises((LinkError, StaleData)):
            async with asyncio.timeout(2.0):
                await moving
        await stands(rig)
        with pytest.raises(LinkError):
            rig.robot.state()


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_a_half_open_line(direction: str) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        for proxy in (rig.rpc, rig.frames):
            getattr(proxy, direction).blocked = True
        with pytest.raises(LinkError):
            async with asyncio.timeout(2.0):
                await moving
        # No heartbeat is sent any more, or none arrives.
        await stands(rig)
        for proxy in (rig.rpc, rig.frames):
            getattr(proxy, direction).blocked = False
        await rearm(rig)
        assert rig.logic.motions == 1


@pytest.mark.parametrize("reply_delay_s", [0.0, 0.1])
async def test_a_state_stream_that_stops_takes_the_link_with_it(reply_delay_s: float) -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        # With slow replies the motion waits for one when its connection falls with the stream.
        rig.rpc.back.delay_s = reply_delay_s
        rig.logic.faults.inject("frames_stop")
        with pytest.raises(LinkError, match="state frame"):
            async with asyncio.timeout(2.0):
                await moving
        await stands(rig)


async def test_a_state_stream_that_begins_in_a_frame_is_not_believed() -> None:
    async with duco_rig(connect_timeout_s=2.0) as rig:
        rig.logic.faults.inject("misaligned")
        with pytest.raises((ProtocolViolation, ConnectTimeout)):
            await rig.robot.connect()


async def test_nobody_there() -> None:
    async with duco_rig(rpc_port=free_port()) as rig:
        with pytest.raises(ConnectTimeout, match="refused"):
            await rig.robot.connect()


async def test_nobody_answers() -> None:
    async with duco_rig(reply_timeout_s=0.3) as rig:
        rig.rpc.back.blocked = True
        with pytest.raises(LinkError):
            await rig.robot.connect()
        rig.rpc.back.blocked = False
        await rig.robot.connect()
        assert np.isfinite(rig.robot.state().joints_rad).all()


async def test_after_a_loss_the_arm_is_stopped_before_anything_else() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        rig.reset()
        stops = rig.logic.stops
        await rearm(rig)
        assert rig.logic.stops > stops
        assert rig.logic.motions == 0


async def test_a_question_that_the_controller_does_not_know_takes_the_link_with_it() -> None:
    async with duco_rig() as rig:
        await rig.robot.connect()
        moving = await begun(rig)
        rig.logic.faults.inject("unknown", call="robotmoving")
        with pytest.raises(LinkError):
            async with asyncio.timeout(2.0):
                await moving
        await stands(rig)
