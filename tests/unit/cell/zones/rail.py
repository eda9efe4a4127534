"""Arms that slide along a rail, step by step, and a zone in the middle of it."""

import asyncio
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.zones.arbiter import ZoneArbiter
from cellctl.cell.zones.zone import Share, Zone
from cellctl.cell.zones.zoned_robot import ZonedRobot
from cellctl.errors.base import CellError
from cellctl.errors.robot import MotionAborted, NotRearmed
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot, RobotMode, RobotState
from tests.unit.cell.zones.loop import time_s

LEFT, MIDDLE, RIGHT = 0.0, 1.5, 3.0
ZONE = Box(np.array([1.0, -1.0, -1.0]), np.array([2.0, 1.0, 1.0]))
TICK_S = 0.02
TICK_M = 0.25
SPEED = {"speed_m_s": 0.1, "acceleration_m_s2": 0.1}


def at(x_m: float) -> RigidTransform:
    return RigidTransform.from_translation([x_m, 0.0, 0.0])


@dataclass
class RailRobot(Robot):
    """Reports its place at every tick only, and goes on for a tick after a move was given up."""

    name: str
    x_m: float = LEFT
    moving: bool = False
    latched: bool = False
    silent: CellError | None = None
    """Raised instead of a report."""
    looks: dict[str, Any] = field(default_factory=dict)
    started: int = 0
    _report: RobotState | None = None
    _braking: asyncio.Task[None] | None = None

    async def connect(self) -> None:
        self.report()

    async def disconnect(self) -> None:
        await self.stop()

    def state(self, max_age_s: float = 0.25) -> RobotState:
        if self.silent is not None:
            raise self.silent
        assert max_age_s > 0.0
        # A standing robot reports all the time, a moving one what it last had.
        if self._report is None or not self.moving:
            self.report()
        assert self._report is not None
        return replace(self._report, **self.looks)

    def report(self) -> None:
        self._report = RobotState(
            time_s=time_s(),
            base_T_flange=at(self.x_m),
            joints_rad=np.full(6, self.x_m),
            mode=RobotMode.REMOTE,
            emergency_stop=False,
            drives_on=True,
            moving=self.moving,
            stop_latched=self.latched,
            error_code=0,
            speed_override_ratio=1.0,
        )

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        assert 0.0 < speed_ratio <= 1.0
        return await self._go(float(joints_rad[0]))

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        assert speed_m_s > 0.0
        assert acceleration_m_s2 > 0.0
        return await self._go(float(base_T_flange.translation[0]))

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        return await self.move_linear(base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=1.0)

    async def stop(self) -> None:
        self.latched = True

    async def rearm(self) -> None:
        self.latched = False

    async def _go(self, target_m: float) -> RobotState:
        if self.latched or self.moving:
            raise NotRearmed(self.name)
        self.started += 1
        self.moving = True
        while abs(target_m - self.x_m) > 1e-9:
            try:
                await asyncio.sleep(TICK_S)
            except asyncio.CancelledError:
                self._give_up(target_m)
                raise
            if self.latched:
                self._give_up(target_m)
                raise MotionAborted(self.name)
            self._advance(target_m)
        self.moving = False
        return self.state()

    def _give_up(self, target_m: float) -> None:
        self.latched = True
        self._braking = asyncio.create_task(self._brake(target_m))

    async def _brake(self, target_m: float) -> None:
        await asyncio.sleep(TICK_S)
        self._advance(target_m)
        self.moving = False

    def _advance(self, target_m: float) -> None:
        self.x_m += float(np.clip(target_m - self.x_m, -TICK_M, TICK_M))
        self.report()


@dataclass
class Rail:
    """Robots with one zone, each asking the arbiter."""

    robots: dict[str, RailRobot]
    zoned: dict[str, ZonedRobot]

    def inside(self) -> list[str]:
        """Robots that really are in the zone."""
        return [
            name
            for name, robot in self.robots.items()
            if ZONE.holds(np.array([robot.x_m, 0.0, 0.0]))
        ]


def rail(
    *,
    wait_s: float = 30.0,
    clear: tuple[float, ...] = (LEFT, RIGHT),
    retreat: tuple[str, ...] = (),
    **at_m: float,
) -> Rail:
    """One robot for each name, standing at its place; joint moves between clear places are free."""
    robots = {name: RailRobot(name, x_m) for name, x_m in at_m.items()}
    poses = tuple(np.full(6, x_m) for x_m in clear)
    middle_m = (ZONE.lower_m[0] + ZONE.upper_m[0]) / 2
    # Each leaves on the side on which it stands.
    shares = {name: Share(ZONE, poses, (0, x_m > middle_m)) for name, x_m in at_m.items()}
    zone = Zone("middle", shares, wait_s, retreat)
    arbiter = ZoneArbiter(
        (zone,), {name: robot.state for name, robot in robots.items()}, clock=time_s
    )
    return Rail(robots, {name: ZonedRobot(one, arbiter, None) for name, one in robots.items()})
