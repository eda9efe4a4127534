"""A digital output of this PC in the permit loop of a robot: a stop that no program has to read.

The contact is closed when the robot is re-armed and opened with every stop of the daemon. Its
coupler opens it by its own watchdog when it no longer hears this PC, and any stop of the guard goes
its own way beside it. It protects the process; it is no safety function.
"""

import asyncio
from collections.abc import Mapping

from cellctl import log
from cellctl.cell.robot_layer import RobotLayer, StreamingRobotLayer
from cellctl.config import CellConfig
from cellctl.errors import CellError
from cellctl.interfaces import DigitalIo, Robot, StreamingRobot

_log = log.get(__name__)


class PermittedRobot(RobotLayer):
    """Stops by the contact and by the link at once; raises what the robot behind it raises."""

    def __init__(self, robot: Robot, io: DigitalIo, output: str) -> None:
        super().__init__(robot)
        self._io, self._output = io, output

    async def stop(self) -> None:
        """The robot confirms the stop; a contact that cannot be opened is only logged, as its
        watchdog opens it then."""
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


def permitted(config: CellConfig, robot: Robot, ios: Mapping[str, DigitalIo]) -> Robot:
    """The robot behind the contact that its section of the cell file names; without one itself."""
    permit = config.robots[robot.name].permit
    if permit is None:
        return robot
    if isinstance(robot, StreamingRobot):
        return PermittedStreamingRobot(robot, ios[permit.device], permit.output)
    return PermittedRobot(robot, ios[permit.device], permit.output)
