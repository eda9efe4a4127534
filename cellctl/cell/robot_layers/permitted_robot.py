"""A digital output of this PC in the permit loop of a robot: a stop that no program has to read.

The contact is closed when the robot is re-armed. It is opened with every stop of the daemon, and
when a motion ends with a fault of its link or an error of the controller: the robot program that
would have obeyed a stop may be the very thing that has ended. The coupler of the output opens the
contact by its own watchdog when it no longer hears this PC. A stop of the guard takes a way of its
own beside the contact. The contact protects the process; it is no safety function.
"""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.cell.robot_layers.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.config import CellConfig
from cellctl.errors import CellError
from cellctl.errors.link import LinkError
from cellctl.errors.robot import ControllerFault
from cellctl.geometry.pose import Array
from cellctl.interfaces import (
    DigitalIo,
    PoseStream,
    Robot,
    RobotState,
    StreamingRobot,
    StreamLimits,
)

_log = log.get(__name__)


class PermittedRobot(RobotLayer):
    """Stops by the contact and by the link at once; raises what the robot behind it raises."""

    def __init__(self, robot: Robot, io: DigitalIo, output: str) -> None:
        super().__init__(robot)
        self._io, self._output = io, output

    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """As the robot behind it; opens the contact when nobody knows how the motion goes on."""
        async with self._opened_on_doubt():
            return await super().move_joint(joints_rad, speed_ratio=speed_ratio)

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """As ``move_joint``."""
        async with self._opened_on_doubt():
            return await super().move_linear(
                base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
            )

    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """As ``move_joint``."""
        async with self._opened_on_doubt():
            return await super().step(base_T_flange, speed_m_s=speed_m_s)

    async def stop(self) -> None:
        """Stop by both ways at once; returns when the robot has confirmed it.

        A contact that cannot be opened is only logged: the coupler's watchdog opens it then.
        """
        opening = asyncio.create_task(self._open())
        try:
            await super().stop()
        finally:
            await asyncio.shield(opening)

    async def rearm(self) -> None:
        """Close the contact first: with an open one the robot stays latched. Moves nothing, since
        the robot's own latch is still set."""
        await self._io.write({self._output: True})
        await super().rearm()

    @asynccontextmanager
    async def _opened_on_doubt(self) -> AsyncIterator[None]:
        try:
            yield
        except (LinkError, ControllerFault):
            # The contact is opened before the fault is raised and its handler stops everything:
            # over the link that has failed, that stop may reach nobody. Every such fault ends the
            # run, so the robot is re-armed, and the contact closed, before anything moves again.
            # Shielded, because a write that is cancelled would leave the contact closed.
            await asyncio.shield(asyncio.create_task(self._open()))
            raise

    async def _open(self) -> None:
        try:
            await self._io.write({self._output: False})
        except CellError as fault:
            _log.warning("permit not opened", robot=self.name, fault=str(fault))


class PermittedStreamingRobot(PermittedRobot, StreamingRobotLayer):
    """The same before a robot that follows a stream."""

    def __init__(self, robot: StreamingRobot, io: DigitalIo, output: str) -> None:
        super().__init__(robot, io, output)
        self._streaming = robot

    @asynccontextmanager
    async def stream(self, limits: StreamLimits) -> AsyncIterator[PoseStream]:
        """As the robot behind it; opens the contact as a move does."""
        async with self._opened_on_doubt(), self._streaming.stream(limits) as stream:
            yield stream


def permitted(config: CellConfig, robot: Robot, ios: Mapping[str, DigitalIo]) -> Robot:
    """The robot behind the contact that its section of the cell file names; without one itself."""
    permit = config.robots[robot.name].permit
    if permit is None:
        return robot
    if isinstance(robot, StreamingRobot):
        return PermittedStreamingRobot(robot, ios[permit.device], permit.output)
    return PermittedRobot(robot, ios[permit.device], permit.output)
