"""Robots that are slower in Maintenance, when people set up boards and parts between the moves.

New poses, fresh calibrations and procedures are tried in that mode, mostly with somebody at the
cell who has to see in time that a move goes wrong. It protects the process; it is no protection of
people.
"""

from collections.abc import Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.cell.robot_layers.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.config import CellConfig
from cellctl.config.devices import MaintenanceSpeeds
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces import PoseStream, Robot, RobotState, StreamingRobot, StreamLimits


@dataclass(slots=True)
class MaintenancePace:
    """Asked before each move whether the unit is in Maintenance now."""

    in_maintenance: Callable[[], bool] = lambda: False


class SlowedRobot(RobotLayer):
    """Holds every move to the speeds of Maintenance while the unit is in it; raises what the robot
    behind it raises."""

    def __init__(self, robot: Robot, speeds: MaintenanceSpeeds, pace: MaintenancePace) -> None:
        super().__init__(robot)
        self._speeds, self._pace = speeds, pace

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """Move at most at the share of rated joint speed that the cell file states."""
        if self._pace.in_maintenance():
            speed_ratio = min(speed_ratio, self._speeds.speed_percent / 100.0)
        return await super().move_joint(joints_rad, speed_ratio=speed_ratio)

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """Move at most at the path speed that the cell file states."""
        return await super().move_linear(
            base_T_flange, speed_m_s=self._held(speed_m_s), acceleration_m_s2=acceleration_m_s2
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """Move at most at the path speed that the cell file states."""
        return await super().step(base_T_flange, speed_m_s=self._held(speed_m_s))

    def _held(self, speed_m_s: float) -> float:
        if not self._pace.in_maintenance():
            return speed_m_s
        return min(speed_m_s, self._speeds.linear_speed_mm_s * MM)


class SlowedStreamingRobot(SlowedRobot, StreamingRobotLayer):
    """The same before a robot that follows a stream."""

    def __init__(
        self, robot: StreamingRobot, speeds: MaintenanceSpeeds, pace: MaintenancePace
    ) -> None:
        super().__init__(robot, speeds, pace)
        self._streaming = robot

    def stream(self, limits: StreamLimits) -> AbstractAsyncContextManager[PoseStream]:
        """A stream that may go faster is refused with ``TargetOutOfBounds``: a loop that was
        designed for its speed must not be slowed down behind its back."""
        speed_mm_s = limits.step_m / MM / self._streaming.stream_offer().period_s
        allowed_mm_s = self._speeds.linear_speed_mm_s
        if self._pace.in_maintenance() and speed_mm_s > allowed_mm_s:
            raise TargetOutOfBounds(
                f"{self.name}: a stream of up to {speed_mm_s:g} mm/s in Maintenance, where "
                f"robots.{self.name}.in_maintenance allows {allowed_mm_s:g}"
            )
        return super().stream(limits)


def slowed(
    config: CellConfig, robots: Mapping[str, Robot], pace: MaintenancePace
) -> Mapping[str, Robot]:
    """All robots by name; those whose section states speeds of Maintenance are held to them."""
    return {name: _slowed(config, robot, pace) for name, robot in robots.items()}


def _slowed(config: CellConfig, robot: Robot, pace: MaintenancePace) -> Robot:
    speeds = config.robots[robot.name].in_maintenance
    if speeds is None:
        return robot
    if isinstance(robot, StreamingRobot):
        return SlowedStreamingRobot(robot, speeds, pace)
    return SlowedRobot(robot, speeds, pace)
