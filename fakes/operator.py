"""The operator of the fake cell: what the control port can ask for."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fakes.control import Handler
from fakes.device import DeviceFaults
from fakes.faults import FaultBoard
from fakes.world.world import Command

if TYPE_CHECKING:
    from fakes.cell import Cell


class Operator:
    """Handlers of the control port: those that every cell has, those of its scene and devices."""

    def __init__(self, cell: "Cell", commands: Mapping[str, Command]) -> None:
        self._cell = cell
        self._commands = commands

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
        channels = {name: robot.open_channels for name, robot in self._cell.robots.items()}
        return {"time_s": self._cell.clock(), "channels": channels}

    async def truth(self) -> dict[str, Any]:
        """Everything that nobody in the cell knows exactly."""
        lost_s = self._cell.clock.lost_s
        return {"truth": {**self._cell.world.report(), "lost_s": lost_s}}

    async def watch_begin(self) -> dict[str, Any]:
        """Watch the motions of the arms from now on."""
        self._cell.watch.begin(self._cell.clock())
        return {}

    async def watched(self) -> dict[str, Any]:
        """Motions of the arms since the watch began."""
        return self._cell.watch.report(self._cell.clock())

    async def master(self, robot: str, joint: int, deg: float) -> dict[str, Any]:
        """Master a joint of a robot anew, so many degrees beside where it was."""
        self._cell.world.arms[robot].master(joint, np.deg2rad(deg))
        return {}

    async def inject(self, device: str, name: str, **parameters: Any) -> dict[str, Any]:
        """Inject a fault; ``count`` limits how often it acts."""
        robot = self._cell.robots.get(device)
        if robot is not None and name == "reboot":
            await robot.reboot()
            return {}
        self._faults_of(device).inject(name, **parameters)
        if device == "world":
            self._cell.world.faults_changed()
        return {}

    async def clear(self, device: str, name: str | None = None) -> dict[str, Any]:
        """End one fault of a device, or all of them."""
        faults = self._faults_of(device)
        if isinstance(faults, FaultBoard):
            faults.clear(name)
        else:
            faults.clear()
        if device == "world":
            self._cell.world.faults_changed()
        return {}

    async def faults(self) -> dict[str, Any]:
        """Faults that can be injected, with their meaning, and those that are."""
        boards = {
            device: faults
            for device, faults in self._cell.faults().items()
            if isinstance(faults, FaultBoard)
        }
        return {
            "known": {device: dict(board.known) for device, board in boards.items()},
            "active": {device: board.names() for device, board in boards.items()},
        }

    async def shutdown(self) -> dict[str, Any]:
        """End the process."""
        self._cell.stopping.set()
        return {}

    def _faults_of(self, device: str) -> FaultBoard | DeviceFaults:
        known = self._cell.faults()
        if device not in known:
            raise ValueError(f"unknown device {device!r}; known: {sorted(known)}")
        return known[device]


def _handler(command: Command) -> Handler:
    """A command of the hands as the control port calls it."""

    async def handle(**members: Any) -> dict[str, Any]:
        return dict(command(**members) or {})

    return handle
