"""What every robot must do. A test class derives from ``RobotContract`` and gives it a bench."""

import asyncio

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, StaleData
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    TargetOutOfBounds,
)
from tests.contracts.suites.robot_bench import RobotBench, within
from tests.contracts.suites.robot_figures import RobotFigures
from tests.contracts.suites.robot_latch import RobotLatch


class RobotContract(RobotFigures, RobotLatch):
    """Written once; no clause may be left out by a driver."""

    # --- connecting

    async def test_connecting_never_moves(self, bench: RobotBench) -> None:
        before = bench.flange()
        await bench.connect()
        assert bench.commands() == 0
        assert not bench.moving()
        assert np.allclose(bench.flange().as_matrix(), before.as_matrix(), atol=1e-12)

    async def test_disconnect_in_any_state(self, bench: RobotBench) -> None:
        await bench.robot.disconnect()
        await bench.connect()
        await bench.robot.disconnect()
        await bench.robot.disconnect()
        with pytest.raises(LinkError):
            bench.robot.state()

    async def test_disconnect_stops_a_motion(self, connected: RobotBench) -> None:
        move = await self.begin(connected)
        await within(4.0, connected.robot.disconnect())
        assert not connected.moving()
        with pytest.raises(CellError):
            await within(1.0, move)

    async def test_connect_again(self, connected: RobotBench) -> None:
        await connected.robot.disconnect()
        await within(5.0, connected.robot.connect())
        await self.rearm(connected)
        await within(3.0, self.move(connected, 2.0))

    # --- state

    async def test_state_is_fresh_and_right(self, connected: RobotBench) -> None:
        state = connected.robot.state()
        assert 0.0 <= now_s() - state.time_s < 0.25
        assert state.joints_rad.shape == (6,)
        self.says_where_it_is(connected)
        assert state.ready

    @staticmethod
    def says_where_it_is(bench: RobotBench) -> None:
        state = bench.robot.state()
        distance_m, angle_rad = state.distance_to(bench.flange())
        assert distance_m < 1e-5
        assert angle_rad < 1e-4
        assert np.allclose(state.joints_rad, bench.joints_rad(), atol=1e-4)

    async def test_stale_state_raises_and_nothing_starts(self, connected: RobotBench) -> None:
        target = self.target(connected, 2.0)
        connected.freeze()
        await asyncio.sleep(0.3)  # the age of the report is what this clause is about
        with pytest.raises((StaleData, LinkError)):
            connected.robot.state(0.25)
        with pytest.raises((StaleData, LinkError)):
            await connected.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
        assert connected.commands() == 0

    # --- motion

    async def test_moves_end_at_standstill_on_target(self, connected: RobotBench) -> None:
        robot = connected.robot
        target = self.target(connected, 3.0)
        state = await within(3.0, robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0))
        assert state.distance_to(target)[0] < 1e-5
        assert not state.moving
        assert not connected.moving()
        target = self.target(connected, -0.3)
        state = await within(3.0, robot.step(target, speed_m_s=0.01))
        assert state.distance_to(target)[0] < 1e-5
        joints_rad = state.joints_rad + np.array([0.01, 0, 0, 0, 0, 0])
        state = await within(3.0, robot.move_joint(joints_rad, speed_ratio=0.5))
        assert np.allclose(state.joints_rad, joints_rad, atol=1e-6)
        assert connected.commands() == 3

    async def test_turns_and_joints_arrive_as_they_were_meant(self, connected: RobotBench) -> None:
        """A wrong order of angles, degrees for radians, or joints in another order show here: no
        two figures are alike, and the bench says where the arm is."""
        robot, here = connected.robot, self.target(connected, 3.0)
        turn = Rotation.from_euler("ZYX", [9.0, -6.0, 4.0], degrees=True)
        tilted = here * RigidTransform.from_rotation(turn)
        await within(5.0, robot.move_linear(tilted, speed_m_s=0.05, acceleration_m_s2=1.0))
        off = tilted.inv() * connected.flange()
        assert np.linalg.norm(off.translation) < 1e-5
        assert off.rotation.magnitude() < 1e-4
        self.says_where_it_is(connected)
        turned_rad = np.array([0.010, -0.008, 0.006, -0.012, 0.014, -0.016])
        joints_rad = robot.state().joints_rad + turned_rad
        await within(3.0, robot.move_joint(joints_rad, speed_ratio=0.5))
        assert np.allclose(connected.joints_rad(), joints_rad, atol=1e-4)
        self.says_where_it_is(connected)

    async def test_one_motion_at_a_time(self, connected: RobotBench) -> None:
        move = await self.begin(connected)
        with pytest.raises(MotionRejected):
            await self.move(connected, 1.0)
        await within(4.0, move)

    async def test_targets_are_bounded(self, connected: RobotBench) -> None:
        robot, here = connected.robot, self.target(connected, 0.0)
        fast, nan = connected.max_speed_m_s * 1.01, float("nan")
        nowhere = RigidTransform.from_translation([np.nan, 0.0, 0.0])
        turn = RigidTransform.from_rotation(Rotation.from_euler("z", 20.0, degrees=True))
        refused = [
            robot.move_linear(connected.outside, speed_m_s=0.05, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=fast, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=-0.05, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=nan, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=nan),
            robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=-1.0),
            robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=float("inf")),
            robot.move_linear(nowhere, speed_m_s=0.05, acceleration_m_s2=1.0),
            robot.move_joint(np.full(6, np.nan), speed_ratio=0.1),
            robot.move_joint(np.zeros(6), speed_ratio=nan),
            robot.move_joint(np.zeros(6), speed_ratio=0.0),
            robot.move_joint(np.zeros(6), speed_ratio=1.01),
            robot.move_joint(connected.outside_joints_rad, speed_ratio=0.1),
            robot.step(connected.outside, speed_m_s=0.01),
            robot.step(nowhere, speed_m_s=0.01),
            robot.step(here, speed_m_s=fast),
            robot.step(here, speed_m_s=nan),
            robot.step(self.target(connected, 50.0), speed_m_s=0.01),
            robot.step(here * turn, speed_m_s=0.01),
        ]
        for move in refused:
            with pytest.raises(TargetOutOfBounds):
                await within(2.0, move)
        assert connected.commands() == 0

    # --- stopping

    async def test_stop_works_twice_and_latches(self, connected: RobotBench) -> None:
        robot = connected.robot
        await within(2.0, robot.stop())
        await within(2.0, robot.stop())
        assert robot.state().stop_latched
        here = self.target(connected, 0.0)
        joints_rad = robot.state().joints_rad
        for move in (
            robot.move_linear(here, speed_m_s=0.05, acceleration_m_s2=1.0),
            robot.step(here, speed_m_s=0.01),
            robot.move_joint(joints_rad, speed_ratio=0.1),
        ):
            with pytest.raises(NotRearmed):
                await move
        assert connected.commands() == 0

    async def test_rearm_never_moves_and_works_twice(self, connected: RobotBench) -> None:
        await within(2.0, connected.robot.stop())
        before = connected.flange()
        await within(2.0, connected.robot.rearm())
        await within(2.0, connected.robot.rearm())
        assert connected.commands() == 0
        assert np.allclose(connected.flange().as_matrix(), before.as_matrix(), atol=1e-12)
        await within(3.0, self.move(connected, 2.0))

    async def test_stop_ends_a_motion_at_standstill(self, connected: RobotBench) -> None:
        move = await self.begin(connected)
        await within(2.0, connected.robot.stop())
        assert not connected.moving()
        with pytest.raises(MotionAborted):
            await within(1.0, move)

    async def test_the_arm_of_the_bench_has_mass(self, connected: RobotBench) -> None:
        """Of the bench, not of the driver: an arm that stands at once shows no driver that does
        not wait for standstill."""
        await self.begin(connected)
        stop, begin_s = asyncio.create_task(connected.robot.stop()), now_s()
        while connected.moving():
            assert now_s() - begin_s < 2.0
            await asyncio.sleep(0.002)
        assert now_s() - begin_s > 0.03
        await within(2.0, stop)

    async def test_a_stop_leaves_the_event_loop_free(self, connected: RobotBench) -> None:
        """Heartbeats of all arms and the answers to the line come from the same loop."""
        await self.begin(connected)
        stop, gaps_s, last_s = asyncio.create_task(connected.robot.stop()), [0.0], now_s()
        while not stop.done():
            await asyncio.sleep(0.005)
            gaps_s.append(now_s() - last_s)
            last_s = now_s()
        await stop
        assert max(gaps_s) < 0.2

    async def test_cancellation_stops_first(self, connected: RobotBench) -> None:
        move = await self.begin(connected)
        move.cancel()
        with pytest.raises(asyncio.CancelledError):
            await within(2.0, move)
        assert not connected.moving()
        with pytest.raises(NotRearmed):
            await self.move(connected, 1.0)

    async def test_link_loss_fails_at_once_and_never_resumes(self, connected: RobotBench) -> None:
        target = self.target(connected, 80.0)
        move = await self.begin(connected)
        connected.cut()
        with pytest.raises(LinkError):
            await within(0.3, move)
        with pytest.raises((LinkError, NotRearmed)):
            await connected.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=1.0)
        await self.rearm(connected)
        assert not connected.moving()
        assert connected.commands() == 1
        assert connected.robot.state().distance_to(target)[0] > 0.01
