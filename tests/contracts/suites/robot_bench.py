"""A robot under test, what its bench must be able to do, and the first steps of every clause."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable
from enum import Enum
from typing import TypeVar

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.geometry.pose import Array
from cellctl.interfaces.motion_bounds import MotionBounds
from cellctl.interfaces.robot import Robot, RobotState

Value = TypeVar("Value")


class Panel(Enum):
    """What at the controller's panel keeps an arm from moving."""

    EMERGENCY_STOP = "emergency stop"
    MANUAL = "key on manual"
    DRIVES_OFF = "drives off"
    ERROR = "error of the controller"


class RobotBench(ABC):
    """A robot under test and what is known about it from outside. ``robot`` is not connected."""

    robot: Robot
    outside: RigidTransform
    """A pose beyond the bounds."""
    outside_joints_rad: Array
    """Joints beyond the bounds, shape (6,)."""
    edge: RigidTransform
    """A pose within the bounds, which the arm reaches in a straight way of less than 0.3 m."""
    beyond_edge: RigidTransform
    """A pose outside of the bounds, not farther from ``edge`` than a step may be."""
    max_speed_m_s: float
    joint_speed_rad_s: float
    """Speed of the first joint at ratio 1, by the data sheet of the arm of the bench."""

    async def connect(self) -> None:
        """Connect the robot; benches whose far end must be started do that here."""
        await self.robot.connect()

    @abstractmethod
    def stated_bounds(self) -> MotionBounds:
        """What the driver's ``bounds`` says of the settings of this bench."""

    @abstractmethod
    def commands(self) -> int:
        """Motions that the controller has been told to make."""

    @abstractmethod
    def flange(self) -> RigidTransform:
        """Where the flange is, whatever the driver says."""

    @abstractmethod
    def joints_rad(self) -> Array:
        """Where the joints are, whatever the driver says; shape (6,)."""

    @abstractmethod
    def moving(self) -> bool:
        """Whether the arm moves, whatever the driver says. It has mass: after a stop it moves on
        for a while."""

    @abstractmethod
    def set_panel(self, panel: Panel) -> None:
        """Press, turn or break it, until the test ends."""

    @abstractmethod
    def turn_override_down(self) -> float:
        """Somebody turns the speed override at the panel below 1; the ratio."""

    @abstractmethod
    def refuse_motion(self) -> None:
        """The controller does not make the next motion that it is told to make."""

    @abstractmethod
    def ignore_stops(self) -> None:
        """The controller overhears every request to stop, until the test ends; its dead man
        works."""

    @abstractmethod
    def release_at_the_panel(self) -> None:
        """Somebody else releases the controller's latch, if it has one, as at its panel."""

    @abstractmethod
    def freeze(self) -> None:
        """The controller's reports stop coming, or repeat themselves, until the test ends."""

    @abstractmethod
    def cut(self) -> None:
        """Break the link. The controller comes back by itself."""


async def within(limit_s: float, awaitable: Awaitable[Value]) -> Value:
    async with asyncio.timeout(limit_s):
        return await awaitable


class RobotClauses(ABC):
    """What the clauses share."""

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

    def move(
        self, bench: RobotBench, dz_mm: float = 80.0, speed_m_s: float = 0.08
    ) -> "asyncio.Task[RobotState]":
        target = self.target(bench, dz_mm)
        move = bench.robot.move_linear(target, speed_m_s=speed_m_s, acceleration_m_s2=1.0)
        return asyncio.create_task(move)

    async def begin(self, bench: RobotBench, speed_m_s: float = 0.08) -> "asyncio.Task[RobotState]":
        """A long motion that has begun."""
        move = self.move(bench, speed_m_s=speed_m_s)
        async with asyncio.timeout(2.0):
            while not bench.moving():
                await asyncio.wait({move}, timeout=0.005)
        return move

    async def rearm(self, bench: RobotBench) -> None:
        """Re-arm as an operator does: again until the link is back and the controller accepts."""
        await self.again(bench.robot.rearm)

    async def reconnect(self, bench: RobotBench) -> None:
        """Connect, again until the link is back, and wait for news of the controller."""
        await self.again(bench.robot.connect)
        await asyncio.sleep(0.2)  # a command that a driver sends with it would have acted by then

    @staticmethod
    async def again(act: Callable[[], Awaitable[object]]) -> None:
        """Until it raises nothing."""
        async with asyncio.timeout(8.0):
            while True:
                try:
                    await act()
                except CellError:
                    await asyncio.sleep(0.05)
                else:
                    return
