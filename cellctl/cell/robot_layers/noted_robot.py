"""Robots that tell whoever listens what they are told to do, for the record of a run."""

from collections.abc import Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import asdict, dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.cell.robot_layers.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.clock import now_s
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.interfaces import PoseStream, Robot, RobotState, StreamingRobot, StreamLimits


@dataclass(frozen=True, slots=True)
class RobotNote:
    """One thing that a robot was told to do, whether it did it or not."""

    robot: str
    time_s: float
    """Monotonic time in seconds."""
    what: str
    values: Mapping[str, Any]
    """Plain data with units in the names."""


Listener = Callable[[RobotNote], None]


class RobotNotes:
    """Puts a layer before each robot of a cell that tells all listeners what it is told to do."""

    def __init__(self) -> None:
        self.listeners: list[Listener] = []

    def noted(self, robot: Robot) -> Robot:
        """A layer before a robot that tells the listeners."""
        if isinstance(robot, StreamingRobot):
            return NotedStreamingRobot(robot, self._tell)
        return NotedRobot(robot, self._tell)

    def _tell(self, note: RobotNote) -> None:
        for listener in self.listeners:
            listener(note)


class NotedRobot(RobotLayer):
    """Notes each command before it passes it on, so that a command that fails is on record too."""

    def __init__(self, robot: Robot, tell: Listener) -> None:
        super().__init__(robot)
        self._tell = tell

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """Note the target and speed, then move."""
        self._note("move_joint", joints_rad=joints_rad.tolist(), speed_ratio=speed_ratio)
        return await super().move_joint(joints_rad, speed_ratio=speed_ratio)

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """Note the target, speed and acceleration, then move."""
        self._note(
            "move_linear",
            base_T_flange_mm_deg=pose_to_xyzabc(base_T_flange).tolist(),
            speed_mm_s=speed_m_s / MM,
            acceleration_mm_s2=acceleration_m_s2 / MM,
        )
        return await super().move_linear(
            base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """Note the target and speed, then move."""
        self._note(
            "step",
            base_T_flange_mm_deg=pose_to_xyzabc(base_T_flange).tolist(),
            speed_mm_s=speed_m_s / MM,
        )
        return await super().step(base_T_flange, speed_m_s=speed_m_s)

    async def stop(self) -> None:
        """Stop, and note it only then: nothing may come between a stop and the robot."""
        try:
            await super().stop()
        finally:
            self._note("stop")

    async def rearm(self) -> None:
        """Note it, then re-arm."""
        self._note("rearm")
        await super().rearm()

    def _note(self, what: str, **values: object) -> None:
        self._tell(RobotNote(self.name, now_s(), what, values))


class NotedStreamingRobot(NotedRobot, StreamingRobotLayer):
    """The same before a robot that follows a stream; its setpoints show in the reports."""

    def __init__(self, robot: StreamingRobot, tell: Listener) -> None:
        super().__init__(robot, tell)

    def stream(self, limits: StreamLimits) -> AbstractAsyncContextManager[PoseStream]:
        """Note the limits, then open the stream."""
        self._note("stream", **asdict(limits))
        return super().stream(limits)
