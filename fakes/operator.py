"""The operator of the fake cell: what the control port can ask for."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fakes.clock import WorldClock
from fakes.control import Handler
from fakes.device import DeviceFaults
from fakes.faults import FaultBoard
from fakes.motion_watch import MotionWatch
from fakes.robot_jobs.controller import JobController
from fakes.wire.sjl.controller import SjlController
from fakes.world.world import Command, World


class Operator:
    """Handlers of the control port: those that every cell has, those of its scene and devices."""

    def __init__(
        self,
        world: World[Any],
        clock: WorldClock,
        watch: MotionWatch,
        *,
        robots: Mapping[str, SjlController | JobController],
        faults: Mapping[str, FaultBoard | DeviceFaults],
        commands: Mapping[str, Command],
        shut_down: Callable[[], None],
    ) -> None:
        """``robots`` are those that connect to the PC by themselves.

        ``faults`` are what can be injected faults into, by name; the bodies are called ``world``.
        ``commands`` are those of the scene and of the devices.
        """
        self._world, self._clock, self._watch = world, clock, watch
        self._robots, self._faults = robots, faults
        self._commands = commands
        self._shut_down = shut_down

    def handlers(self) -> dict[str, Handler]:
        """Commands by name."""
        return {
            **{name: _handler(command) for name, command in self._commands.items()},
            "status": self.status,
            "truth": self.truth,
            "watch_begin": self.watch_begin,
            "watched": self.watched,
            "master": self.master,
            "inject": self.inject,
            "clear": self.clear,
            "faults": self.faults,
            "shutdown": self.shutdown,
        }

    async def status(self) -> dict[str, Any]:
        """Time of the world and the channels that the PC has accepted."""
        channels = {name: robot.open_channels for name, robot in self._robots.items()}
        return {"time_s": self._clock(), "channels": channels}

    async def truth(self) -> dict[str, Any]:
        """Everything that nobody in the cell knows exactly."""
        return {"truth": {**self._world.report(), "lost_s": self._clock.lost_s}}

    async def watch_begin(self) -> dict[str, Any]:
        """Watch the motions of the arms from now on."""
        self._watch.begin(self._clock())
        return {}

    async def watched(self) -> dict[str, Any]:
        """Motions of the arms since the watch began."""
        return self._watch.report(self._clock())

    async def master(self, robot: str, joint: int, deg: float) -> dict[str, Any]:
        """Master a joint of a robot anew, so many degrees beside where it was."""
        self._world.arms[robot].master(joint, np.deg2rad(deg))
        return {}

    async def inject(self, device: str, name: str, **parameters: Any) -> dict[str, Any]:
        """Inject a fault; ``count`` limits how often it acts."""
        robot = self._robots.get(device)
        if robot is not None and name == "reboot":
            await robot.reboot()
            return {}
        self._faults_of(device).inject(name, **parameters)
        if device == "world":
            self._world.faults_changed()
        return {}

    async def clear(self, device: str, name: str | None = None) -> dict[str, Any]:
        """End one fault of a device, or all of them."""
        faults = self._faults_of(device)
        if isinstance(faults, FaultBoard):
            faults.clear(name)
        else:
            faults.clear()
        if device == "world":
            self._world.faults_changed()
        return {}

    async def faults(self) -> dict[str, Any]:
        """Faults that can be injected, with their meaning, and those that are."""
        boards = {
            device: faults
            for device, faults in self._faults.items()
            if isinstance(faults, FaultBoard)
        }
        return {
            "known": {device: dict(board.known) for device, board in boards.items()},
            "active": {device: board.names() for device, board in boards.items()},
        }

    async def shutdown(self) -> dict[str, Any]:
        """End the process."""
        self._shut_down()
        return {}

    def _faults_of(self, device: str) -> FaultBoard | DeviceFaults:
        if device not in self._faults:
            raise ValueError(f"unknown device {device!r}; known: {sorted(self._faults)}")
        return self._faults[device]


def _handler(command: Command) -> Handler:
    """A command of the hands as the control port calls it."""

    async def handle(**members: Any) -> dict[str, Any]:
        return dict(command(**members) or {})

    return handle
