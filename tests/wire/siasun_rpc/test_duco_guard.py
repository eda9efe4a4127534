"""Guard and daemon at one controller that has no latch: no motion goes on after a stop."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import pytest

from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.errors.robot import MotionAborted, NotRearmed
from cellctl.interfaces.stop_channel import FlangeState
from drivers.robot.siasun_rpc.stop_channel import WORDS, SiasunRpcStopChannel
from tests.rigs.wire.duco_rig import DucoRig, duco_rig
from tests.wire.siasun_rpc.duco_moves import begun, move, rearm, stands


@asynccontextmanager
async def cell() -> AsyncIterator[tuple[DucoRig, SiasunRpcStopChannel]]:
    """Daemon's driver and guard's channel, both connected."""
    async with duco_rig() as rig:
        await rig.robot.connect()
        guard = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(guard.open)
        try:
            yield rig, guard
        finally:
            guard.close()


async def beats(guard: SiasunRpcStopChannel, until: Callable[[FlangeState | None], bool]) -> None:
    """Beat and read, as the guard does, until a report, or the lack of one, meets a condition."""
    async with asyncio.timeout(2.0):
        while not until(guard.poll()):
            guard.heartbeat()
            await asyncio.sleep(0.02)


async def test_the_daemon_sees_the_guards_stop_and_waits_for_rearm() -> None:
    async with cell() as (rig, guard):
        moving = await begun(rig)
        guard.request_stop()
        with pytest.raises((MotionAborted, NotRearmed)):
            await moving
        await stands(rig)
        with pytest.raises(NotRearmed):
            await move(rig, 1.0)
        await rearm(rig)
        await move(rig, 1.0)
        assert rig.logic.words[1] == rig.logic.words[2] == 1


async def test_a_stop_of_the_guard_while_the_arm_stands_shows_before_the_next_motion() -> None:
    async with cell() as (rig, guard):
        assert not rig.robot.state().unasked_latch
        guard.request_stop()
        await beats(guard, lambda state: state is not None and state.stop_latched)
        await rig.robot._link.watch.wait(lambda report: report.guard_stopped, 2.0)
        assert rig.robot.state().unasked_latch
        # Once the driver was asked to stop as well, as after a touch, it is nobody's any more.
        await rig.robot.stop()
        assert not rig.robot.state().unasked_latch
        await rearm(rig)
        assert not rig.robot.state().stop_latched


async def test_the_guard_sees_the_daemons_rearm() -> None:
    async with cell() as (rig, guard):
        guard.request_stop()
        await beats(guard, lambda state: state is not None and state.stop_latched)
        await rearm(rig)
        await beats(guard, lambda state: state is not None and not state.stop_latched)


@pytest.mark.parametrize("delay_ms", [0, 2, 5, 10, 20, 40])
async def test_in_whatever_order_a_motion_does_not_outlive_a_stop(delay_ms: int) -> None:
    async with cell() as (rig, guard):
        moving = move(rig, 80.0)
        await asyncio.sleep(delay_ms / 1000)
        guard.request_stop()
        with pytest.raises(CellError):
            async with asyncio.timeout(1.5):
                await moving
        await stands(rig)
        assert rig.logic.words[1] == 1


async def test_a_motion_that_overtakes_the_first_stop_is_ended_by_the_second() -> None:
    async with cell() as (rig, guard):
        stop, calls = rig.logic.stop, []

        def overtaken() -> int:
            number = stop()
            calls.append(number)
            if len(calls) == 1:
                # Here, between the guard's two stops, the daemon's call is accepted.
                rig.logic.move_joint([0.5, *rig.logic.joints()[1:]], 10.0)
            return number

        rig.logic.stop = overtaken  # type: ignore[method-assign]
        guard.request_stop()
        async with asyncio.timeout(2.0):
            while len(calls) < 2:  # noqa: ASYNC110 - the fake tells nobody
                await asyncio.sleep(0.005)
        assert rig.logic.motions == 1
        await stands(rig)


async def test_a_stop_during_a_rearm_is_not_lost() -> None:
    async with cell() as (rig, guard):
        await rig.robot.stop()
        releasing = asyncio.create_task(rig.robot.rearm())
        await asyncio.sleep(0)
        guard.request_stop()
        await asyncio.wait({releasing}, timeout=4.0)
        releasing.exception()
        if rig.logic.words[1] != rig.logic.words[2]:
            with pytest.raises(NotRearmed):
                await move(rig, 1.0)
        else:
            # The arm stood, and the operator's release came after the stop.
            assert not rig.logic.moving()


async def test_a_stream_ends_at_the_guards_stop() -> None:
    async with cell() as (rig, guard):
        limits = rig.robot.stream_offer().limits

        async def streamed() -> None:
            async with rig.robot.stream(limits) as stream:
                here = stream.report.base_T_flange
                for count in range(200):
                    if count == 5:
                        guard.request_stop()
                    await stream.advance(here)

        with pytest.raises((MotionAborted, NotRearmed)):
            await streamed()
        await stands(rig)
        with pytest.raises(NotRearmed):
            await move(rig, 1.0)


async def test_the_count_goes_on_after_a_restart_of_the_guard() -> None:
    async with cell() as (rig, guard):
        guard.request_stop()
        await beats(guard, lambda _: rig.logic.words[1] == 1)
        again = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(again.open)
        again.request_stop()
        await beats(again, lambda _: rig.logic.words[1] == 2)
        again.close()


async def test_the_count_begins_again() -> None:
    async with duco_rig() as rig:
        rig.logic.words[1] = rig.logic.words[2] = WORDS
        guard = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(guard.open)
        guard.request_stop()
        await beats(guard, lambda _: rig.logic.words[1] == 1)
        guard.close()


async def test_a_silent_controller_is_a_fault_of_the_guards_channel() -> None:
    async with cell() as (rig, guard):
        rig.logic.faults.inject("silent")
        with pytest.raises(LinkError):
            await beats(guard, lambda _: False)
        assert guard.fileno() == -1


@pytest.mark.parametrize("way", ["split", "delayed"])
async def test_the_guards_channel_on_a_bad_but_honest_line(way: str) -> None:
    async with cell() as (rig, guard):
        for direction in (rig.rpc.forth, rig.rpc.back):
            direction.split = way == "split"
            direction.delay_s = 0.02 if way == "delayed" else 0.0
        await beats(guard, lambda state: state is not None)
        guard.request_stop()
        await beats(guard, lambda state: state is not None and state.stop_latched)


async def test_a_damaged_answer_is_a_fault_of_the_guards_channel() -> None:
    async with duco_rig() as rig:
        guard = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(guard.open)
        rig.rpc.back.corrupt_in = 1
        with pytest.raises(LinkError):
            await beats(guard, lambda _: False)
        assert guard.fileno() == -1
        await asyncio.to_thread(guard.open)
        await beats(guard, lambda state: state is not None and state.stop_latched)
        guard.close()
