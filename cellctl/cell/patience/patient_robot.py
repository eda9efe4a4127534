"""A robot whose driver may not come back from a move although the arm has long stood still."""

import asyncio
from collections.abc import Coroutine
from dataclasses import dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.cell.patience.calls import answer_within, done_or_left, leave
from cellctl.cell.robot_layers.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.errors.link import ReplyTimeout
from cellctl.geometry.pose import Array
from cellctl.interfaces import PendantSelection, Robot, RobotState, StreamingRobot

_STANDS_M, _STANDS_RAD = 20e-6, 1e-4
"""An arm stands as long as it is no farther than this from where it was first seen. Reports of an
arm that stands differ by a few micrometres. The slowest move that any process asks for, 20 µm/s,
leaves these bounds after a second, and so long before ``StandingTime.most_s``."""


@dataclass(frozen=True, slots=True)
class StandingTime:
    """How long an arm may stand within a move, as at a speed override of zero."""

    most_s: float = 30.0
    """Long enough for a person to turn an override of zero up again."""
    look_s: float = 0.5
    """Pause between two looks: short beside ``most_s``, and it costs nothing."""


class PatientRobot(RobotLayer):
    """Ends a move that does not come back while the arm stands: ``ReplyTimeout``.

    A bound on the whole move would have to know the way, the speed and the override at the pendant.
    That an arm gets nowhere is seen without them. The stop is not bounded here: the machine bounds
    it, and says which arm has not confirmed it.
    """

    def __init__(self, robot: Robot, standing: StandingTime = StandingTime()) -> None:
        super().__init__(robot)
        self._standing = standing

    async def connect(self) -> None:
        """As the robot behind it, within a time."""
        await answer_within(super().connect(), self.name)

    async def disconnect(self) -> None:
        """As the robot behind it, within a time."""
        await answer_within(super().disconnect(), self.name)

    async def selection(self) -> PendantSelection:
        """As the robot behind it, within a time."""
        return await answer_within(super().selection(), self.name)

    async def rearm(self) -> None:
        """As the robot behind it, within a time."""
        await answer_within(super().rearm(), self.name)

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """As the robot behind it, unless the arm gets nowhere."""
        return await self._moved(super().move_joint(joints_rad, speed_ratio=speed_ratio))

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """As the robot behind it, unless the arm gets nowhere."""
        return await self._moved(
            super().move_linear(
                base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
            )
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """As the robot behind it, unless the arm gets nowhere."""
        return await self._moved(super().step(base_T_flange, speed_m_s=speed_m_s))

    async def _moved(self, move: Coroutine[Any, Any, RobotState]) -> RobotState:
        moving = asyncio.create_task(move)
        standing = asyncio.create_task(self._stands())
        try:
            await done_or_left(moving, {moving, standing})
        finally:
            standing.cancel()
        if not moving.done():
            await leave(moving)
            raise ReplyTimeout(
                f"{self.name}: its driver has not come back from a move, and the arm has stood for "
                f"{self._standing.most_s:g} s"
            )
        return moving.result()

    async def _stands(self) -> None:
        """Returns when the arm has not moved for too long."""
        at: RobotState | None = None
        since_s = now_s()
        while now_s() - since_s < self._standing.most_s:
            await asyncio.sleep(self._standing.look_s)
            try:
                state = self.state()
            except CellError:
                continue  # supervision raises the fault of a robot that is silent
            if at is None or _has_moved(at, state):
                at, since_s = state, now_s()


class PatientStreamingRobot(PatientRobot, StreamingRobotLayer):
    """The same for a robot that follows a stream; a stream that stays away is a standstill."""

    def __init__(self, robot: StreamingRobot, standing: StandingTime = StandingTime()) -> None:
        super().__init__(robot, standing)


def patient_robot(robot: Robot) -> Robot:
    """The robot behind the layer that suits it."""
    if isinstance(robot, StreamingRobot):
        return PatientStreamingRobot(robot)
    return PatientRobot(robot)


def _has_moved(before: RobotState, now: RobotState) -> bool:
    distance_m, angle_rad = before.distance_to(now.base_T_flange)
    return distance_m > _STANDS_M or angle_rad > _STANDS_RAD
