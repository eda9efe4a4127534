"""A robot in memory: the shortest honest implementation of the interface."""

import asyncio
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkLost, StaleData
from cellctl.errors.robot import (
    MotionAborted,
    MotionRejected,
    NotRearmed,
    RobotNotReady,
    StopFailed,
    TargetOutOfBounds,
)
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array
from cellctl.interfaces.motion_bounds import MotionBounds
from cellctl.interfaces.robot import Robot, RobotMode, RobotState

HOME = RigidTransform.from_translation([1.5, 0.0, 1.0])
MAX_SPEED_M_S = 0.2
MAX_STEP_M = 0.0005
REACH_M = 2.0
RATED_RAD_S = 1.0
AT_REACH = tuple(
    RigidTransform.from_translation(HOME.translation / np.linalg.norm(HOME.translation) * length_m)
    for length_m in (REACH_M - 1e-4, REACH_M + 1e-4)
)
"""Just within and just beyond it."""
_TICK_S = 0.005
MAX_STEP_RAD = 0.02
_STANDS_AFTER_S = 0.04
"""So long after a stop it still counts as moving, as an arm with mass does."""


class InProcessRobot(Robot):
    """Moves at constant speed in real time; a linear motion leaves the joints as they are."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.flange = HOME
        self.joints_rad: Array = np.zeros(6)
        self.commands = 0
        self.frozen_at_s: float | None = None
        self.emergency_stop, self.drives_on, self.mode = False, True, RobotMode.REMOTE
        self.error_code, self.override_ratio = 0, 1.0
        self.refuses = self.deaf = False
        self._connected = False
        self._latched = False
        self._stands_from_s = 0.0
        self._motion: asyncio.Task[None] | None = None
        self._end: CellError | None = None

    @classmethod
    def bounds(cls, config: Any) -> MotionBounds:
        reach = Box(np.full(3, -REACH_M), np.full(3, REACH_M))
        return MotionBounds(flange_box=reach, speed_m_s=MAX_SPEED_M_S)

    @property
    def moving(self) -> bool:
        """A motion runs, or ends."""
        return self._motion is not None or now_s() < self._stands_from_s

    async def connect(self) -> None:
        self._connected = True

    async def disconnect(self) -> None:
        self._halt(LinkLost("disconnected"))
        await self._standstill()
        self._connected = False

    def cut(self) -> None:
        """Cut the link as when the cable breaks for a moment."""
        self._halt(LinkLost("cable"))

    def state(self, max_age_s: float = 0.25) -> RobotState:
        if not self._connected:
            raise LinkLost("not connected")
        time_s = self.frozen_at_s or now_s()
        if now_s() - time_s > max_age_s:
            raise StaleData("frozen")
        return RobotState(
            time_s=time_s,
            base_T_flange=self.flange,
            joints_rad=self.joints_rad,
            mode=self.mode,
            emergency_stop=self.emergency_stop,
            drives_on=self.drives_on,
            moving=self.moving,
            stop_latched=self._latched,
            error_code=self.error_code,
            speed_override_ratio=self.override_ratio,
        )

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        if not (np.all(np.abs(joints_rad) < np.pi) and 0.0 < speed_ratio <= 1.0):
            raise TargetOutOfBounds("joints")
        way_rad = float(np.abs(joints_rad - self.joints_rad).max())
        duration_s = way_rad / (speed_ratio * RATED_RAD_S)
        return await self._move(self.flange, joints_rad, duration_s)

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        ramped = 0.0 < acceleration_m_s2 < np.inf
        if not (np.linalg.norm(base_T_flange.translation) < REACH_M and ramped):
            raise TargetOutOfBounds("reach")
        if not 0.0 < speed_m_s <= MAX_SPEED_M_S:
            raise TargetOutOfBounds("speed")
        duration_s = self.state().distance_to(base_T_flange)[0] / speed_m_s
        duration_s += speed_m_s / acceleration_m_s2
        return await self._move(base_T_flange, self.joints_rad, duration_s)

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        if not np.isfinite(base_T_flange.as_matrix()).all():
            raise TargetOutOfBounds("step")
        way_m, turn_rad = self.state().distance_to(base_T_flange)
        if not (way_m <= MAX_STEP_M and turn_rad <= MAX_STEP_RAD):
            raise TargetOutOfBounds("step")
        return await self.move_linear(base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=1.0)

    async def stop(self) -> None:
        self.state()
        self._latched = True
        if self.deaf:
            await self.disconnect()
            raise StopFailed("not confirmed")
        self._halt(MotionAborted("stop"))
        await self._standstill()

    async def rearm(self) -> None:
        self.state()
        await self._standstill()
        self._latched = False

    def _halt(self, reason: CellError) -> None:
        if self._motion is not None:
            self._latched, self._end = True, reason
            self._motion.cancel()
            self._motion = None
            self._stands_from_s = now_s() + _STANDS_AFTER_S

    async def _standstill(self) -> None:
        while self.moving:  # noqa: ASYNC110  no event for it
            await asyncio.sleep(_TICK_S)

    async def _move(self, flange: RigidTransform, joints_rad: Array, time_s: float) -> RobotState:
        self.state()
        if self._motion is not None:
            raise MotionRejected("busy")
        if self._latched:
            raise NotRearmed("latched")
        if not self.state().ready:
            raise RobotNotReady("panel")
        if self.refuses:
            raise MotionRejected("refused")
        self.commands += 1
        self._end = None
        motion = self._motion = asyncio.create_task(self._run(flange, joints_rad, time_s))
        try:
            await asyncio.wait({motion})
        except asyncio.CancelledError:
            await self.stop()
            raise
        if self._end is not None:
            raise self._end
        return self.state()

    async def _run(self, flange: RigidTransform, joints_rad: Array, time_s: float) -> None:
        start, way = self.flange, self.flange.inv() * flange
        begun_s = now_s()
        while (elapsed_s := now_s() - begun_s) < time_s:
            if self.frozen_at_s is not None:
                self._halt(StaleData("frozen"))
            self.flange = start * RigidTransform.from_exp_coords(
                way.as_exp_coords() * elapsed_s / time_s
            )
            await asyncio.sleep(_TICK_S)
        self.flange, self.joints_rad, self._motion = flange, joints_rad, None
