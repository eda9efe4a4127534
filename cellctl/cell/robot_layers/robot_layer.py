"""What stands before a driver and lets everything through: the base of layers that add to it."""

from contextlib import AbstractAsyncContextManager

from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from cellctl.geometry.pose import Array
from cellctl.interfaces import (
    PendantSelection,
    PoseStream,
    Robot,
    RobotState,
    StreamingRobot,
    StreamLimits,
)
from cellctl.interfaces.streaming_robot import StreamOffer


class RobotLayer(Robot):
    """Passes each call on, a stop above all; raises what the robot behind it raises."""

    def __init__(self, robot: Robot) -> None:
        self.name = robot.name
        self._robot = robot

    async def connect(self) -> None:
        """As the robot behind it."""
        await self._robot.connect()

    async def disconnect(self) -> None:
        """As the robot behind it."""
        await self._robot.disconnect()

    def incidents(self) -> tuple[CellError, ...]:
        """Those of the robot behind it."""
        return self._robot.incidents()

    def state(self, max_age_s: float = 0.25) -> RobotState:
        """State of the robot behind it."""
        return self._robot.state(max_age_s)

    def link_facts(self) -> dict[str, str]:
        """Those of the robot behind it."""
        return self._robot.link_facts()

    def round_trips_s(self) -> tuple[float, ...]:
        """Those of the robot behind it."""
        return self._robot.round_trips_s()

    def least_acceleration_m_s2(self) -> float:
        """That of the robot behind it."""
        return self._robot.least_acceleration_m_s2()

    async def selection(self) -> PendantSelection:
        """What is selected at the pendant of the robot behind it."""
        return await self._robot.selection()

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """As the robot behind it."""
        return await self._robot.move_joint(joints_rad, speed_ratio=speed_ratio)

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """As the robot behind it."""
        return await self._robot.move_linear(
            base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """As the robot behind it."""
        return await self._robot.step(base_T_flange, speed_m_s=speed_m_s)

    async def stop(self) -> None:
        """As the robot behind it."""
        await self._robot.stop()

    async def rearm(self) -> None:
        """As the robot behind it."""
        await self._robot.rearm()


class StreamingRobotLayer(RobotLayer, StreamingRobot):
    """The same before a robot that follows a stream."""

    def __init__(self, robot: StreamingRobot) -> None:
        super().__init__(robot)
        self._streaming = robot

    def stream_offer(self) -> StreamOffer:
        """What the robot behind it offers."""
        return self._streaming.stream_offer()

    def stream(self, limits: StreamLimits) -> AbstractAsyncContextManager[PoseStream]:
        """As the robot behind it."""
        return self._streaming.stream(limits)
