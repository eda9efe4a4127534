"""A robot whose moves ask the arbiter of the zones first."""

from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager

from scipy.spatial.transform import RigidTransform

from cellctl.cell.robot_layers.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.cell.zones.arbiter import REPORT_AGE_S, ZoneArbiter
from cellctl.cell.zones.ways import Way, joint_way, linear_way, stream_way
from cellctl.cell.zones.zone import zones_of
from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.errors.robot import NotRearmed
from cellctl.geometry.pose import Array
from cellctl.interfaces import PoseStream, Robot, RobotState, StreamingRobot, StreamLimits
from cellctl.interfaces.robot import ForwardKinematics


class ZonedRobot(RobotLayer):
    """Stands before a driver. Everything but a move goes straight through, a stop above all.

    Moves raise ``ZoneTaken`` beside what the driver raises. A move that waits for a zone is given
    up by a stop: it raises ``NotRearmed``, also when the robot was re-armed meanwhile.
    """

    def __init__(
        self, robot: Robot, arbiter: ZoneArbiter, kinematics: ForwardKinematics | None
    ) -> None:
        super().__init__(robot)
        self._arbiter, self._kinematics = arbiter, kinematics
        self._stops = 0

    async def disconnect(self) -> None:
        """Disconnect; a move that waits for a zone is given up."""
        self._stops += 1
        await super().disconnect()

    async def stop(self) -> None:
        """Stop; a move that waits for a zone is given up."""
        self._stops += 1
        await super().stop()

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """Move once all zones on the way are granted: the way by forward kinematics, else the
        taught poses."""
        return await self._move(
            lambda: joint_way(self.state(REPORT_AGE_S), joints_rad, self._kinematics),
            lambda: self._robot.move_joint(joints_rad, speed_ratio=speed_ratio),
        )

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """Move once all zones on the straight line are granted."""
        return await self._move(
            lambda: linear_way(self.state(REPORT_AGE_S), base_T_flange),
            lambda: self._robot.move_linear(
                base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
            ),
        )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """Move once all zones on the straight line are granted."""
        return await self._move(
            lambda: linear_way(self.state(REPORT_AGE_S), base_T_flange),
            lambda: self._robot.step(base_T_flange, speed_m_s=speed_m_s),
        )

    async def _move(
        self, plan: Callable[[], Way], move: Callable[[], Awaitable[RobotState]]
    ) -> RobotState:
        async with self._passage(plan):
            return await move()

    def _passage(self, plan: Callable[[], Way]) -> AbstractAsyncContextManager[None]:
        stops = self._stops

        def plan_unless_stopped() -> Way:
            # The driver's own latch may have been released meanwhile: what was stopped must not
            # begin by itself.
            if self._stops != stops:
                raise NotRearmed(f"{self.name}: a stop was requested while it waited for a zone")
            return plan()

        return self._arbiter.passage(self.name, plan_unless_stopped)


class ZonedStreamingRobot(ZonedRobot, StreamingRobotLayer):
    """The same before a robot that follows a stream."""

    def __init__(
        self, robot: StreamingRobot, arbiter: ZoneArbiter, kinematics: ForwardKinematics | None
    ) -> None:
        super().__init__(robot, arbiter, kinematics)

    @asynccontextmanager
    async def stream(self, limits: StreamLimits) -> AsyncIterator[PoseStream]:
        """Stream once all zones that its setpoints may reach are granted."""
        async with (
            self._passage(lambda: stream_way(self.state(REPORT_AGE_S), limits.travel_m)),
            self._streaming.stream(limits) as stream,
        ):
            yield stream


def zoned_robots(config: CellConfig, robots: Mapping[str, Robot]) -> Mapping[str, Robot]:
    """All robots by name; those that share a zone ask the cell's arbiter."""
    zones = zones_of(config)
    arbiter = ZoneArbiter(zones, {name: robot.state for name, robot in robots.items()})
    sharing = {name for zone in zones for name in zone.shares}
    return {
        name: _zoned(config, robot, arbiter) if name in sharing else robot
        for name, robot in robots.items()
    }


def _zoned(config: CellConfig, robot: Robot, arbiter: ZoneArbiter) -> ZonedRobot:
    driver, settings = robot_driver(config.robots[robot.name])
    kinematics = driver.forward_kinematics(settings)
    if isinstance(robot, StreamingRobot):
        return ZonedStreamingRobot(robot, arbiter, kinematics)
    return ZonedRobot(robot, arbiter, kinematics)
