"""What every robot that follows a stream of setpoints must do, besides the contract of robots."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    StreamSilent,
    StreamStale,
    TargetOutOfBounds,
)
from cellctl.interfaces.streaming_robot import (
    PoseStream,
    StreamingRobot,
    StreamLimits,
    StreamReport,
)
from tests.contracts.suites.robot_bench import RobotBench, within

Body = Callable[[PoseStream], Awaitable[object]]
CLOSE_M = 2e-6
"""A pose on the wire is rounded to 0.1 µm."""


class StreamingBench(RobotBench):
    """A robot under test that can stream, and what can go wrong with a stream."""

    robot: StreamingRobot

    @abstractmethod
    def lose_setpoints(self, count: int) -> None:
        """The next setpoints do not reach the controller."""

    @abstractmethod
    def repeat_setpoint(self) -> None:
        """The next setpoint reaches the controller twice."""

    @abstractmethod
    def delay_setpoint(self) -> None:
        """The next setpoint reaches the controller after its tick."""

    @abstractmethod
    def silence_ticks(self) -> None:
        """The controller's ticks are not heard any more; its state reports are."""


def raised(report: StreamReport, dz_m: float, turn_rad: float = 0.0) -> RigidTransform:
    """A setpoint straight above where a report was, turned about the flange's own z."""
    turn = RigidTransform.from_rotation(Rotation.from_rotvec([0.0, 0.0, turn_rad]))
    return RigidTransform.from_translation([0.0, 0.0, dz_m]) * report.base_T_flange * turn


async def hold_at(stream: PoseStream, target: RigidTransform, ticks: int = 10) -> StreamReport:
    """Send one setpoint again and again."""
    for _ in range(ticks):
        await stream.advance(target)
    return stream.report


async def hold(stream: PoseStream, ticks: int = 10) -> StreamReport:
    """Send the present pose again and again."""
    return await hold_at(stream, stream.report.base_T_flange, ticks)


async def climb(stream: PoseStream) -> None:
    """Straight up for as long as the stream allows, half a step a tick."""
    start, step_m = stream.report, stream.limits.step_m / 2
    for number in range(1, int(stream.limits.travel_m / step_m)):
        await stream.advance(raised(start, number * step_m))


class StreamingRobotContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> StreamingBench:
        """A fresh bench, torn down after the test."""

    @pytest.fixture
    async def connected(self, bench: StreamingBench) -> StreamingBench:
        await bench.connect()
        return bench

    @staticmethod
    def limits(bench: StreamingBench) -> StreamLimits:
        return bench.robot.stream_offer().limits

    def stream(self, bench: StreamingBench, body: Body) -> "asyncio.Task[None]":
        """A stream in a task of its own."""
        limits = self.limits(bench)

        async def streamed() -> None:
            async with bench.robot.stream(limits) as stream:
                await body(stream)

        return asyncio.create_task(streamed())

    async def begin(self, bench: StreamingBench) -> "asyncio.Task[None]":
        """A long stream whose arm is on its way."""
        before = bench.flange()
        climbing = self.stream(bench, climb)
        async with asyncio.timeout(3.0):
            while np.linalg.norm(bench.flange().translation - before.translation) < 1e-4:
                done, _ = await asyncio.wait({climbing}, timeout=0.005)
                assert not done, climbing
        return climbing

    async def standing(self, bench: StreamingBench) -> RigidTransform:
        """Where the flange is once it stands, which must be soon; it must stay there."""
        async with asyncio.timeout(1.0):
            while bench.moving():  # noqa: ASYNC110  the arm tells nobody
                await asyncio.sleep(0.005)
        here = bench.flange()
        await asyncio.sleep(0.1)  # nothing may resume
        assert np.allclose(bench.flange().as_matrix(), here.as_matrix(), atol=1e-12)
        return here

    async def rearm(self, bench: StreamingBench) -> None:
        """Re-arm as an operator does: again until the link is back and the controller accepts."""
        async with asyncio.timeout(5.0):
            while True:
                try:
                    return await bench.robot.rearm()
                except CellError:
                    await asyncio.sleep(0.05)

    async def works_again(self, bench: StreamingBench) -> None:
        """Show that it works, but not before it is re-armed."""
        with pytest.raises((NotRearmed, LinkError)):
            await self.stream(bench, hold)
        await self.rearm(bench)
        await within(3.0, self.stream(bench, hold))

    # --- what is offered

    async def test_the_offer(self, bench: StreamingBench) -> None:
        with pytest.raises(LinkError):
            bench.robot.stream_offer()
        await bench.connect()
        offer = bench.robot.stream_offer()
        assert 0.0005 <= offer.period_s <= 0.1
        assert all(getattr(offer.limits, field.name) > 0.0 for field in fields(StreamLimits))
        assert offer.limits.loss_s >= 2.0 * offer.period_s

    @pytest.mark.parametrize("figure", [field.name for field in fields(StreamLimits)])
    @pytest.mark.parametrize("factor", [0.0, -1.0, 1.01, float("nan"), float("inf")])
    async def test_limits_beyond_the_offer_are_refused(
        self, connected: StreamingBench, figure: str, factor: float
    ) -> None:
        limits = self.limits(connected)
        asked = replace(limits, **{figure: factor * getattr(limits, figure)})
        with pytest.raises(TargetOutOfBounds):
            async with connected.robot.stream(asked):
                pytest.fail("entered")
        assert connected.commands() == 0

    # --- following

    async def test_entering_and_leaving_moves_nothing(self, connected: StreamingBench) -> None:
        before = connected.flange()
        async with connected.robot.stream(self.limits(connected)) as stream:
            assert stream.report.tick >= 1
            assert stream.period_s == connected.robot.stream_offer().period_s
            assert (
                np.linalg.norm(stream.report.base_T_flange.translation - before.translation)
                < CLOSE_M
            )
        assert not connected.moving()
        assert np.allclose(connected.flange().as_matrix(), before.as_matrix(), atol=1e-9)
        state = connected.robot.state()
        assert not state.stop_latched
        assert not state.moving

    async def test_the_flange_follows(self, connected: StreamingBench) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            start, limits = stream.report, stream.limits
            target = start.base_T_flange
            for number in range(1, 31):
                target = raised(start, number * limits.step_m * 0.9, number * limits.step_rad * 0.9)
                report = await stream.advance(target)
                assert now_s() - report.time_s < 0.2
            await hold_at(stream, target)
            delta = stream.report.base_T_flange.inv() * target
        assert np.linalg.norm(delta.translation) < CLOSE_M
        assert delta.rotation.magnitude() < 1e-5
        assert np.linalg.norm(connected.flange().translation - target.translation) < CLOSE_M

    async def test_every_tick_has_its_number_and_its_pose(self, connected: StreamingBench) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            start, step_m = stream.report, stream.limits.step_m / 2
            before = start
            assert start.sent_s == start.time_s, "nothing was sent yet"
            for number in range(1, 21):
                asked_s = now_s()
                report = await stream.advance(raised(start, number * step_m))
                assert asked_s <= report.sent_s <= now_s()
                assert report.tick > before.tick
                assert report.time_s >= before.time_s
                assert (report.late, report.lost) >= (before.late, before.lost)
                way_m = np.linalg.norm(
                    report.base_T_flange.translation - before.base_T_flange.translation
                )
                ticks = report.tick - before.tick
                assert way_m <= ticks * stream.limits.step_m + CLOSE_M
                before = report

    async def test_standstill_within_a_stream(self, connected: StreamingBench) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            await stream.advance(raised(stream.report, stream.limits.step_m))
            await hold(stream, 5)
            first = await hold(stream)
            last = await hold(stream)
        way_m = first.base_T_flange.translation - last.base_T_flange.translation
        assert np.linalg.norm(way_m) < CLOSE_M

    async def test_a_motion_and_a_stream_after_each_other(self, connected: StreamingBench) -> None:
        robot = connected.robot
        await within(3.0, self.stream(connected, hold))
        here = robot.state().base_T_flange
        target = RigidTransform.from_translation([0.0, 0.0, 0.002]) * here
        await within(3.0, robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0))
        await within(3.0, self.stream(connected, hold))

    async def test_one_motion_at_a_time(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        here = connected.robot.state().base_T_flange
        with pytest.raises(MotionRejected):
            await connected.robot.step(here, speed_m_s=0.01)
        with pytest.raises(MotionRejected):
            await self.stream(connected, hold)
        assert not climbing.done()
        climbing.cancel()
        await asyncio.wait({climbing}, timeout=2.0)

    # --- limits

    async def test_setpoints_beyond_the_limits_are_not_sent(
        self, connected: StreamingBench
    ) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            start, limits = stream.report, stream.limits
            refused = [
                raised(start, limits.step_m * 1.01),
                raised(start, 0.0, limits.step_rad * 1.01),
                RigidTransform.from_translation([np.nan, 0.0, 0.0]),
                connected.outside,
            ]
            for target in refused:
                with pytest.raises(TargetOutOfBounds):
                    await stream.advance(target)
            report = await stream.advance(raised(start, limits.step_m))  # counts from the start
            await stream.advance(raised(start, 2.0 * limits.step_m))
            assert report.tick > start.tick

    async def test_travel_is_limited(self, connected: StreamingBench) -> None:
        limits = replace(self.limits(connected), travel_m=self.limits(connected).step_m * 3.5)
        async with connected.robot.stream(limits) as stream:
            start = stream.report
            for number in (1, 2, 3):
                await stream.advance(raised(start, number * limits.step_m))
            with pytest.raises(TargetOutOfBounds):
                await stream.advance(raised(start, 4 * limits.step_m))
            await stream.advance(raised(start, 2 * limits.step_m))

    async def test_after_a_refused_setpoint_the_arm_goes_no_further(
        self, connected: StreamingBench
    ) -> None:
        """It was not sent: the arm stands at the last one, and does not run through the dead time
        of a stop. The stream has ended, and the robot is latched."""
        start, step_m = connected.flange(), self.limits(connected).step_m

        async def follow(stream: PoseStream) -> None:
            begun = stream.report
            for number in (1, 2, 3, 4):
                await stream.advance(raised(begun, number * step_m))
            await stream.advance(raised(begun, 9 * step_m))

        with pytest.raises(TargetOutOfBounds):
            await within(5.0, self.stream(connected, follow))
        assert not connected.moving()
        travelled_m = connected.flange().translation - start.translation
        assert np.linalg.norm(travelled_m) < 4 * step_m + CLOSE_M
        assert connected.robot.state().stop_latched
        with pytest.raises(NotRearmed):
            async with connected.robot.stream(self.limits(connected)):
                pytest.fail("entered")

    # --- late, lost, repeated

    async def test_a_lost_setpoint_is_counted_and_never_made_up_for_at_once(
        self, connected: StreamingBench
    ) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            start, step_m = stream.report, stream.limits.step_m
            before = await hold(stream, 5)
            connected.lose_setpoints(3)
            last = before
            for number in range(1, 12):
                report = await stream.advance(raised(start, min(number, 6) * step_m))
                ticks = report.tick - last.tick
                way_m = report.base_T_flange.translation - last.base_T_flange.translation
                assert np.linalg.norm(way_m) <= ticks * step_m + CLOSE_M
                last = report
            await hold_at(stream, raised(start, 6 * step_m))
            # A busy PC may send two setpoints for one tick, and the controller does not miss one of
            # them. Further ones are lost until it has missed three.
            for _ in range(5):
                if stream.report.lost < before.lost + 3:
                    connected.lose_setpoints(3)
                    await hold_at(stream, raised(start, 6 * step_m))
            assert stream.report.lost >= before.lost + 3
        assert abs(connected.flange().translation[2] - start.base_T_flange.translation[2]) < (
            6 * step_m + CLOSE_M
        )

    async def test_a_late_and_a_repeated_setpoint_are_counted(
        self, connected: StreamingBench
    ) -> None:
        async with connected.robot.stream(self.limits(connected)) as stream:
            before = await hold(stream, 5)
            connected.delay_setpoint()
            await hold(stream, 5)
            late = stream.report.late
            assert late > before.late
            connected.repeat_setpoint()
            await hold(stream, 5)
            assert stream.report.late > late

    # --- how a stream ends

    async def test_without_setpoints_the_robot_stands(self, connected: StreamingBench) -> None:
        loss_s = self.limits(connected).loss_s

        async def stall(stream: PoseStream) -> None:
            await stream.advance(raised(stream.report, stream.limits.step_m))
            await asyncio.sleep(5.0 * loss_s)
            await stream.advance(stream.report.base_T_flange)

        with pytest.raises(StreamStale):
            await within(5.0, self.stream(connected, stall))
        await self.standing(connected)
        assert connected.robot.state().stop_latched
        await self.works_again(connected)

    async def test_setpoints_that_are_lost_for_too_long(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        connected.lose_setpoints(10_000)
        with pytest.raises(StreamStale):
            await within(3.0, climbing)
        await self.standing(connected)
        connected.lose_setpoints(0)
        await self.works_again(connected)

    async def test_an_end_that_nobody_looked_at_is_raised_on_leaving(
        self, connected: StreamingBench
    ) -> None:
        async def sleep(stream: PoseStream) -> None:
            await asyncio.sleep(5.0 * stream.limits.loss_s)

        with pytest.raises(StreamStale):
            await within(5.0, self.stream(connected, sleep))
        await self.works_again(connected)

    async def test_silent_ticks_stop_the_robot(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        connected.silence_ticks()
        with pytest.raises(StreamSilent):
            await within(3.0, climbing)
        await self.standing(connected)
        assert connected.robot.state().stop_latched

    async def test_cancellation_stops_first_and_latches(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        climbing.cancel()
        with pytest.raises(asyncio.CancelledError):
            await within(2.0, climbing)
        assert not connected.moving()
        await self.standing(connected)
        await self.works_again(connected)

    async def test_an_exception_stops_first_and_latches(self, connected: StreamingBench) -> None:
        class Broken(Exception):
            pass

        async def fail(stream: PoseStream) -> None:
            await stream.advance(raised(stream.report, stream.limits.step_m))
            raise Broken

        with pytest.raises(Broken):
            await within(3.0, self.stream(connected, fail))
        assert not connected.moving()
        await self.standing(connected)
        await self.works_again(connected)

    async def test_stop_ends_a_stream_at_standstill(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        await within(2.0, connected.robot.stop())
        assert not connected.moving()
        with pytest.raises(MotionAborted):
            await within(1.0, climbing)
        await self.standing(connected)
        await self.works_again(connected)

    async def test_nothing_streams_while_a_stop_is_latched(self, connected: StreamingBench) -> None:
        await within(2.0, connected.robot.stop())
        await self.works_again(connected)

    async def test_link_loss_fails_at_once_and_never_resumes(
        self, connected: StreamingBench
    ) -> None:
        climbing = await self.begin(connected)
        connected.cut()
        with pytest.raises(LinkError):
            await within(0.5, climbing)
        await self.standing(connected)
        await self.works_again(connected)

    async def test_disconnect_stops_a_stream(self, connected: StreamingBench) -> None:
        climbing = await self.begin(connected)
        await within(4.0, connected.robot.disconnect())
        with pytest.raises(CellError):
            await within(1.0, climbing)
        await self.standing(connected)
