"""The SIASUN driver's stream: literal records by a scripted peer, then faults against the fake."""

import asyncio
import contextlib
from collections.abc import AsyncIterator

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, ProtocolViolation, ReplyTimeout
from cellctl.errors.robot import (
    ControllerFault,
    MotionAborted,
    MotionRejected,
    NotRearmed,
    SetpointRefused,
    StreamNotOffered,
    StreamSilent,
    StreamStale,
)
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces.streaming_robot import PoseStream, StreamLimits
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from tests.rigs.wire.siasun_cell import HERE, LATCHED, Cell, running
from tests.rigs.wire.siasun_peer import POSE
from tests.rigs.wire.sjl_rig import Rig, sjl_rig

LIMITS = StreamLimits(5e-5, np.radians(0.02), 0.01, np.radians(2.0), 0.1)
STREAM_TEXT = "0.0500,0.0200,10.0000,2.0000,100"
OPTION = "STREAM=8/0.1000/0.0500/30.0000/5.0000/200"


def above(dz_mm: float) -> RigidTransform:
    return pose_from_xyzabc([*HERE[:2], HERE[2] + dz_mm, *HERE[3:]])


def tick(cell: Cell, number: int, taken: int = 0, late: int = 0, lost: int = 0) -> None:
    cell.cmd.send(f"TICK,{number},{20 * number},{taken},{late},{lost},{POSE}")


async def accepted(cell: Cell) -> None:
    """Play the controller's part until the first tick."""
    assert await cell.cmd.expect() == f"STREAM,{cell.cmd.session},1,{STREAM_TEXT}"
    cell.cmd.send("ACK,1")
    tick(cell, 1)


@contextlib.asynccontextmanager
async def streaming(cell: Cell) -> AsyncIterator[PoseStream]:
    """The inside of a stream, with a controller that finishes it when it is asked to."""

    async def begin() -> None:
        await accepted(cell)

    beginning = asyncio.create_task(begin())
    async with cell.robot.stream(LIMITS) as stream:
        await beginning
        yield stream
        finishing = asyncio.create_task(finished(cell))
    await finishing


async def finished(cell: Cell) -> None:
    assert await cell.cmd.expect_word("FINISH") == f"FINISH,{cell.cmd.session},1"
    cell.cmd.send(f"DONE,1,{POSE}")
    await asyncio.sleep(0)
    cell.sta.stat()


@contextlib.asynccontextmanager
async def offering() -> AsyncIterator[Cell]:
    """A connected driver whose controller offers streams."""
    async with running(option=OPTION) as cell:
        yield cell


async def test_records_of_a_stream() -> None:
    async with offering() as cell:
        reporting = asyncio.create_task(reports(cell))
        async with streaming(cell) as stream:
            assert (stream.report.tick, stream.report.late, stream.report.lost) == (1, 0, 0)
            advancing = asyncio.create_task(stream.advance(above(-0.04)))
            expected = (
                f"SET,{cell.cmd.session},2,1900.0000,-0.1250,926.9600,90.0000,0.0000,180.0000"
            )
            assert await cell.cmd.expect() == expected
            tick(cell, 2, 2, 3, 4)
            report = await advancing
            assert (report.tick, report.late, report.lost) == (2, 3, 4)
            assert abs(now_s() - report.time_s) < 1.0
            tick(cell, 3, 2)
            tick(cell, 4, 2)
            while stream._command.tick.number < 4:  # type: ignore[attr-defined]  # noqa: ASYNC110
                await asyncio.sleep(0)
            advancing = asyncio.create_task(stream.advance(above(-0.08)))
            assert (await cell.cmd.expect()).startswith(f"SET,{cell.cmd.session},5,")
            tick(cell, 5, 5)
            assert (await advancing).tick == 5
        reporting.cancel()
        move = cell.move()  # no latch: the next command counts on
        assert (await cell.cmd.expect()).startswith(f"MOVL,{cell.cmd.session},2,")
        cell.cmd.send("REJ,2,LIMIT")
        with pytest.raises(MotionRejected):
            await move


async def reports(cell: Cell) -> None:
    while True:
        cell.sta.stat()
        await asyncio.sleep(0.02)


async def answered(cell: Cell, answer: str) -> None:
    """A stream whose first setpoint is answered like this."""
    async with streaming(cell) as stream:
        advancing = asyncio.create_task(stream.advance(above(-0.04)))
        await cell.cmd.expect_word("SET")
        cell.cmd.send(answer)
        await advancing


@pytest.mark.parametrize(
    ("reason", "fault"),
    [("STALE", StreamStale), ("STEP", SetpointRefused), ("TRAVEL", SetpointRefused),
     ("REACH", SetpointRefused), ("SINGULAR", SetpointRefused), ("LIMIT", SetpointRefused),
     ("STOP", MotionAborted), ("ESTOP", MotionAborted), ("ERROR", ControllerFault),
     ("WHATEVER", MotionAborted)],
)  # fmt: skip
async def test_ends_by_the_controller(reason: str, fault: type[CellError]) -> None:
    async with offering() as cell:
        with pytest.raises(fault, match=reason):
            await answered(cell, f"ABRT,1,{reason},{POSE}")
        cell.sta.stat()
        with pytest.raises(NotRearmed):
            await cell.move()
        assert cell.robot.state().stop_latched


@pytest.mark.parametrize(
    ("answer", "fault"),
    [("REJ,1,STREAM", StreamNotOffered), ("REJ,1,BUSY", MotionRejected), ("DUP,1", MotionRejected)],
)
async def test_refusals_leave_no_latch(answer: str, fault: type[CellError]) -> None:
    async with offering() as cell:
        entering = asyncio.create_task(enter(cell))
        await cell.cmd.expect_word("STREAM")
        cell.cmd.send(answer)
        with pytest.raises(fault):
            await entering
        cell.sta.stat()
        assert not cell.robot.state().stop_latched


async def enter(cell: Cell) -> None:
    async with cell.robot.stream(LIMITS):
        pytest.fail("entered")


async def stopped(cell: Cell) -> None:
    """Play the controller's part in a stop."""
    abort = (await cell.sta.expect_word("ABORT")).split(",")
    cell.sta.send(f"STOPD,{abort[2]},{POSE}")
    cell.sta.stat(LATCHED)


async def test_silence_after_stream_stops_the_robot() -> None:
    async with offering() as cell:
        entering = asyncio.create_task(enter(cell))
        await cell.cmd.expect_word("STREAM")
        await stopped(cell)
        with pytest.raises(ReplyTimeout):
            await entering


async def test_cancelling_before_the_answer_stops_the_robot() -> None:
    async with offering() as cell:
        entering = asyncio.create_task(enter(cell))
        await cell.cmd.expect_word("STREAM")
        entering.cancel()
        await stopped(cell)
        with pytest.raises(asyncio.CancelledError):
            await entering
        with pytest.raises(NotRearmed):
            await cell.move()


async def test_no_first_tick() -> None:
    async with offering() as cell:
        entering = asyncio.create_task(enter(cell))
        await cell.cmd.expect_word("STREAM")
        cell.cmd.send("ACK,1")
        await stopped(cell)
        with pytest.raises(StreamSilent):
            await entering


@pytest.mark.parametrize("answer", [f"DONE,1,{POSE}", "ACK,1", f"TICK,2,40,9,0,0,{POSE}"])
async def test_answers_that_make_no_sense(answer: str) -> None:
    async with offering() as cell:
        stopping = asyncio.create_task(stopped(cell))
        with pytest.raises(ProtocolViolation):
            await answered(cell, answer)
        stopping.cancel()
        with pytest.raises((NotRearmed, LinkError)):
            await cell.move()


async def test_a_caller_that_gave_up_waiting_sends_nothing_twice() -> None:
    async with offering() as cell, streaming(cell) as stream:
        advancing = asyncio.create_task(stream.advance(above(-0.04)))
        assert ",2,1900" in await cell.cmd.expect_word("SET")
        advancing.cancel()
        await asyncio.gather(advancing, return_exceptions=True)
        advancing = asyncio.create_task(stream.advance(above(-0.08)))
        await asyncio.wait({advancing}, timeout=0.02)
        tick(cell, 2, 2)
        assert ",3,1900" in await cell.cmd.expect_word("SET")
        tick(cell, 3, 3)
        assert (await advancing).tick == 3


async def test_ticks_after_the_end_are_passed_over() -> None:
    async with offering() as cell:
        async with streaming(cell):
            pass
        tick(cell, 9)
        move = cell.move()
        assert (await cell.cmd.expect()).startswith("MOVL")
        cell.cmd.send("REJ,2,LIMIT")
        with pytest.raises(MotionRejected):
            await move


async def test_a_job_program_without_the_option() -> None:
    async with running() as cell:
        assert cell.robot.link_facts()["streamed motion"] == "not offered"
        with pytest.raises(StreamNotOffered):
            cell.robot.stream_offer()
        with pytest.raises(StreamNotOffered):
            await enter(cell)


async def test_the_configuration_bounds_the_offer() -> None:
    async with running(option=OPTION, max_stream_step_mm=0.02, max_stream_loss_s=0.1) as cell:
        offer = cell.robot.stream_offer()
        assert offer.period_s == 0.008
        assert offer.limits.step_m == pytest.approx(2e-5)
        assert offer.limits.loss_s == pytest.approx(0.1)
        assert offer.limits.travel_m == pytest.approx(0.03)


# --- against the fake controller


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    async with sjl_rig() as rig:
        await rig.connect()
        yield rig


async def test_what_one_channel_offers_is_offered(rig: Rig) -> None:
    assert rig.robot.link_facts()["streamed motion"] == "offered"


async def climb(rig: Rig, ticks: int = 40) -> None:
    """Up by half a step a tick."""
    async with rig.robot.stream(rig.robot.stream_offer().limits) as stream:
        start, step_m = stream.report.base_T_flange, stream.limits.step_m / 2
        for number in range(1, ticks + 1):
            up = RigidTransform.from_translation([0.0, 0.0, number * step_m])
            await stream.advance(up * start)


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_split_packets_change_nothing(rig: Rig, direction: str) -> None:
    getattr(rig.wires["CMD"], direction).split = True
    async with asyncio.timeout(5.0):
        await climb(rig)


async def test_merged_ticks_are_skipped_not_replayed(rig: Rig) -> None:
    rig.wires["CMD"].forth.merge_bytes = 300
    async with asyncio.timeout(5.0):
        async with rig.robot.stream(rig.robot.stream_offer().limits) as stream:
            before = stream.report.tick
            for _ in range(5):
                await stream.advance(stream.report.base_T_flange)
            rig.wires["CMD"].forth.merge_bytes = 0
            assert stream.report.tick - before > 5


async def test_late_packets_are_waited_for(rig: Rig) -> None:
    rig.wires["CMD"].back.delay_s = 0.05
    async with asyncio.timeout(5.0):
        async with rig.robot.stream(rig.robot.stream_offer().limits) as stream:
            for _ in range(10):
                report = await stream.advance(stream.report.base_T_flange)
    assert report.late + report.lost >= 5


@pytest.mark.parametrize("direction", ["forth", "back"])
async def test_a_digit_that_changes_on_the_way_is_seen(rig: Rig, direction: str) -> None:
    climbing = asyncio.create_task(climb(rig, 400))
    await until_moving(rig)
    getattr(rig.wires["CMD"], direction).corrupt_in = 30
    with pytest.raises(LinkError):
        async with asyncio.timeout(2.0):
            await climbing
    async with asyncio.timeout(2.0):
        while moving(rig):  # noqa: ASYNC110  the arm tells nobody
            await asyncio.sleep(0.005)


def moving(rig: Rig) -> bool:
    return rig.controller.logic.moving(rig.controller._clock())


@pytest.mark.parametrize(("direction", "fault"), [("forth", StreamSilent), ("back", StreamStale)])
async def test_half_open_command_channel(rig: Rig, direction: str, fault: type[CellError]) -> None:
    climbing = asyncio.create_task(climb(rig, 400))
    await until_moving(rig)
    getattr(rig.wires["CMD"], direction).blocked = True
    with pytest.raises(fault):
        async with asyncio.timeout(3.0):
            await climbing
    assert not moving(rig)
    assert rig.robot.state().stop_latched


async def until_moving(rig: Rig) -> None:
    """Wait until setpoints have arrived; a stream as such begins before."""
    async with asyncio.timeout(2.0):
        while not rig.arm.moving(rig.controller._clock()):  # noqa: ASYNC110  as above
            await asyncio.sleep(0.002)


def guard_stop(
    channel: SiasunStopChannel, armed: "asyncio.Event", loop: asyncio.AbstractEventLoop
) -> bool:
    """The guard's part: beat, then stop on the first motion that it sees; True when latched."""
    deadline_s = now_s() + 5.0
    asked = False
    with channel:
        loop.call_soon_threadsafe(armed.set)
        while now_s() < deadline_s:
            channel.heartbeat()
            state = channel.poll()
            if state is not None and state.moving and not asked:
                channel.request_stop()
                asked = True
            if asked and state is not None and state.stop_latched and not state.moving:
                return True
    return False


async def test_the_guard_stops_a_stream() -> None:
    async with sjl_rig(channels=("CMD", "STA", "GRD")) as rig:
        channel, armed = SiasunStopChannel(rig.guard), asyncio.Event()
        loop = asyncio.get_running_loop()
        guarding = asyncio.create_task(asyncio.to_thread(guard_stop, channel, armed, loop))
        await rig.connect()
        async with asyncio.timeout(5.0):
            await armed.wait()
            with pytest.raises(MotionAborted, match="STOP"):
                await climb(rig, 500)
            assert await guarding
        assert not moving(rig)
        with pytest.raises(NotRearmed):
            await climb(rig)
