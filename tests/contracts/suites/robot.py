"""What every robot must do. A test class derives from ``RobotContract`` and gives it a bench."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Awaitable
from typing import TypeVar

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkError, StaleData
from cellctl.errors.robot import MotionAborted, MotionRejected, NotRearmed, TargetOutOfBounds
from cellctl.interfaces.robot import Robot, RobotState

Value = TypeVar("Value")
Move = "asyncio.Task[RobotState]"


class RobotBench(ABC):
    """A robot under test and what is known about it from outside. ``robot`` is not connected."""

    robot: Robot
    outside: RigidTransform
    """A pose beyond the bounds."""
    max_speed_m_s: float

    async def connect(self) -> None:
        """Connect the robot; benches whose far end must be started do that here."""
        await self.robot.connect()

    @abstractmethod
    def commands(self) -> int:
        """Motions that the controller has been told to make."""

    @abstractmethod
    def flange(self) -> RigidTransform:
        """Where the flange is, whatever the driver says."""

    @abstractmethod
    def moving(self) -> bool:
        """Whether the arm moves, whatever the driver says."""

    @abstractmethod
    def freeze(self) -> None:
        """The controller's reports stop coming, or repeat themselves, until the test ends."""

    @abstractmethod
    def cut(self) -> None:
        """Break the link. The controller comes back by itself."""


async def within(limit_s: float, awaitable: Awaitable[Value]) -> Value:
    async with asyncio.timeout(limit_s):
        return await awaitable


class RobotContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    async def bench(self) -> RobotBench:
        """A fresh bench, torn down after the test."""

    @pytest.fixture
    async def connected(self, bench: RobotBench) -> RobotBench:
        await bench.connect()
        return bench

    @staticmethod
    def target(bench: RobotBench, dz_mm: float) -> RigidTransform:
        here = bench.robot.state().base_T_flange
        return RigidTransform.from_translation([0.0, 0.0, dz_mm / 1000]) * here

    def move(self, bench: RobotBench, dz_mm: float = 80.0) -> "asyncio.Task[RobotState]":
        target = self.target(bench, dz_mm)
        move = bench.robot.move_linear(target, speed_m_s=0.08, acceleration_m_s2=1.0)
        return asyncio.create_task(move)

    async def begin(self, bench: RobotBench) -> "asyncio.Task[RobotState]":
        """A long motion that has begun."""
        move = self.move(bench)
        async with asyncio.timeout(2.0):
            while not bench.moving():
                await asyncio.wait({move}, timeout=0.005)
        return move

    async def rearm(self, bench: RobotBench) -> None:
        """Re-arm as an operator does: again until the link is back and the controller accepts."""
        async with asyncio.timeout(5.0):
            while True:
                try:
                    return await bench.robot.rearm()
                except CellError:
                    await asyncio.sleep(0.05)

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
        assert state.distance_to(connected.flange())[0] < 1e-6
        assert state.ready

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

    async def test_one_motion_at_a_time(self, connected: RobotBench) -> None:
        move = await self.begin(connected)
        with pytest.raises(MotionRejected):
            await self.move(connected, 1.0)
        await within(4.0, move)

    async def test_targets_are_bounded(self, connected: RobotBench) -> None:
        robot, here = connected.robot, self.target(connected, 0.0)
        fast = connected.max_speed_m_s * 1.01
        refused = [
            robot.move_linear(connected.outside, speed_m_s=0.05, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=fast, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=-0.05, acceleration_m_s2=1.0),
            robot.move_linear(here, speed_m_s=float("nan"), acceleration_m_s2=1.0),
            robot.move_joint(np.full(6, np.nan), speed_ratio=0.1),
            robot.move_joint(np.zeros(6), speed_ratio=1.01),
            robot.step(connected.outside, speed_m_s=0.01),
            robot.step(self.target(connected, 50.0), speed_m_s=0.01),
        ]
        for move in refused:
            with pytest.raises(TargetOutOfBounds):
                await move
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
