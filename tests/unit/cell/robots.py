"""A robot that arrives at once, or waits on its way until the test lets it."""

import asyncio
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.robot import MotionAborted, NotRearmed, TargetOutOfBounds
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot, RobotMode, RobotState
from tests.unit.cell.guard import TinyGuard

FAR_M = 5.0


@dataclass
class Move:
    """What was commanded."""

    kind: str
    target: Any
    speed: float


@dataclass
class StillRobot(Robot):
    """Joint moves lead to the poses it was taught; without one the flange stays."""

    name: str
    flange: RigidTransform = field(
        default_factory=lambda: RigidTransform.from_translation([1.5, 0.0, 1.6])
    )
    joints_rad: Array = field(default_factory=lambda: np.full(6, 0.3))
    taught: list[tuple[Array, RigidTransform]] = field(default_factory=list)
    moves: list[Move] = field(default_factory=list)
    road_is_free: asyncio.Event | None = None
    """Set by a test that wants to catch the robot on its way."""
    on_the_way: asyncio.Event = field(default_factory=asyncio.Event)
    faults: dict[str, CellError] = field(default_factory=dict)
    """Raised by the method of that name."""
    looks: dict[str, Any] = field(default_factory=dict)
    """Fields of the state that differ."""
    latched: bool = False
    stops: int = 0
    watched_by: TinyGuard | None = None
    """No move may begin while this guard is not armed."""

    async def connect(self) -> None:
        self._meet("connect")

    async def disconnect(self) -> None:
        self._meet("disconnect")

    def state(self, max_age_s: float = 0.25) -> RobotState:
        self._meet("state")
        state = RobotState(
            time_s=now_s(),
            base_T_flange=self.flange,
            joints_rad=self.joints_rad,
            mode=RobotMode.REMOTE,
            emergency_stop=False,
            drives_on=True,
            moving=False,
            stop_latched=self.latched,
            error_code=0,
            speed_override_ratio=1.0,
        )
        return replace(state, **self.looks)

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        flange = self.flange
        for joints, pose in self.taught:
            if np.allclose(joints, joints_rad):
                flange = pose
        await self._go(Move("joint", joints_rad, speed_ratio))
        self.joints_rad, self.flange = np.asarray(joints_rad), flange
        return self.state()

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        if not np.linalg.norm(base_T_flange.translation) < FAR_M:
            raise TargetOutOfBounds("reach")
        await self._go(Move("linear", base_T_flange, speed_m_s))
        self.flange = base_T_flange
        self.joints_rad = self.joints_rad + 0.01
        return self.state()

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        return await self.move_linear(base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=1.0)

    async def stop(self) -> None:
        self.stops += 1
        self.latched = True
        self._meet("stop")

    async def rearm(self) -> None:
        self._meet("rearm")
        self.latched = False

    async def _go(self, move: Move) -> None:
        if self.latched:
            raise NotRearmed(self.name)
        self._meet("move")
        assert self.watched_by is None or self.watched_by.armed, "a move without the force guard"
        self.moves.append(move)
        self.on_the_way.set()
        try:
            if self.road_is_free is not None:
                await self.road_is_free.wait()
            else:
                await asyncio.sleep(0)
        except asyncio.CancelledError:
            await self.stop()
            raise
        if self.latched:
            raise MotionAborted(self.name)

    def _meet(self, method: str) -> None:
        if method in self.faults:
            raise self.faults[method]
