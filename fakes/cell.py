"""The fake cell as one process: the world on its clock, its devices on their sockets."""

import asyncio
import errno
import json
import signal
import sys
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from fakes.clock import WorldClock
from fakes.control import ControlServer
from fakes.device import DeviceFaults
from fakes.devices import DeviceRack
from fakes.faults import JOB_FAULTS, ROBOT_FAULTS, FaultBoard
from fakes.motion_watch import MotionWatch
from fakes.operator import Operator
from fakes.priority import stand_apart
from fakes.robot_jobs.controller import JobController
from fakes.robot_jobs.installation import Adaptation
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import Robot
from fakes.scenes.load import open_world
from fakes.wire.sjl.controller import SjlController
from fakes.wire.sjl.stream import StreamOffer
from fakes.world.world import Command

_ADVANCE_S = 0.002


class PortTaken(OSError):
    """Another program listens on a port of the fake cell."""


class Cell:
    """World and devices. ``start`` returns the ports; ``run`` lets the time pass."""

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        ports: dict[str, int] | None = None,
        gentl: Path | None = None,
    ) -> None:
        """``ports`` override those of the scenario: device, ``robot.CHANNEL`` or ``control``.

        ``gentl`` is the file of the cameras that the fake GenTL producer shows; without one there
        are frame servers.
        """
        self._ports = ports or {}
        self._control_port = self._ports.get("control", scenario.control_port)
        self.clock = WorldClock()
        self.world = open_world(scenario, seed)
        self.watch = MotionWatch(self.world.arms)
        self._rack = DeviceRack(self.world, self.clock, self._ports, gentl)
        self.robots = {
            name: self._controller(name, robot)
            for name, robot in scenario.robots.items()
            # Those are servers of the rack. The others here connect to the PC by themselves, as
            # their job programs do.
            if robot.controller != "rpc"
        }
        self.stopping = asyncio.Event()
        self.operator = Operator(
            self.world,
            self.clock,
            self.watch,
            robots=self.robots,
            faults=self._faults(),
            commands=self.commands(),
            shut_down=self.stopping.set,
        )
        self._control = ControlServer(self.operator.handlers())

    def commands(self) -> Mapping[str, Command]:
        """What the hands of an operator can do in this cell, by name."""
        commands = {**self.world.commands(), **self._rack.commands()}
        if any(isinstance(robot, JobController) for robot in self.robots.values()):
            commands["acknowledge"] = self._acknowledge
        return commands

    def _acknowledge(self, robot: str) -> None:
        """Reset the alarm of a controller at its pendant and start its main job again."""
        controller = self.robots.get(robot)
        if not isinstance(controller, JobController) or not controller.alarm:
            raise ValueError(f"{robot!r} shows no alarm of a job")
        controller.acknowledge()

    def _faults(self) -> Mapping[str, FaultBoard | DeviceFaults]:
        return {
            **{name: robot.faults for name, robot in self.robots.items()},
            **{name: device.faults for name, device in self._rack.devices.items()},
            "world": self.world.faults,
        }

    async def start(self) -> dict[str, int]:
        """Listen everywhere, let the robots look for their PC; returns the ports by name.

        Raises ``PortTaken`` for the first device that cannot listen.
        """
        listening = {
            name: await _listen(name, device.port, device.start())
            for name, device in self._rack.devices.items()
        }
        listening = {name: port for name, port in listening.items() if port}
        for robot in self.robots.values():
            robot.start()
        control = self._control.start(port=self._control_port)
        listening["control"] = await _listen("control", self._control_port, control)
        return listening

    async def run(self) -> None:
        """Advance the world until ``stopping`` is set."""
        self.clock()
        self.clock.lost_s = 0.0  # what was lost before, nobody was there to miss
        while not self.stopping.is_set():
            now_s = self.clock()
            self.world.advance(now_s)
            # The watch looks after each advance, so that it sees every place that the arms were at.
            self.watch.sample(now_s)
            await asyncio.sleep(_ADVANCE_S)

    async def stop(self) -> None:
        """Hang up everywhere. Idempotent."""
        self.stopping.set()
        # Robots first: they alone connect by themselves, and would look for their PC again.
        await asyncio.gather(*(robot.stop() for robot in self.robots.values()))
        await asyncio.gather(*(device.stop() for device in self._rack.devices.values()))
        await self._control.stop()
        self._rack.shut_down()

    def _controller(self, name: str, robot: Robot) -> SjlController | JobController:
        ports = {
            channel: self._ports.get(f"{name}.{channel}", port)
            for channel, port in robot.ports.items()
        }
        if robot.controller == "jobs":
            return JobController(
                self.world.arms[name],
                self.clock,
                ports,
                faults=FaultBoard(name, JOB_FAULTS),
                statement_s=robot.statement_ms / 1000,
                adaptation=Adaptation(robot.name, robot.step_max_mm, robot.deadman_ms),
                contact_closed=self._rack.contact(robot.permit),
            )
        return SjlController(
            self.world.arms[name],
            self.clock,
            ports,
            faults=FaultBoard(name, ROBOT_FAULTS),
            offer=_offer(robot) if robot.streams else None,
            contact_closed=self._rack.contact(robot.permit),
        )


def _offer(robot: Robot) -> StreamOffer:
    """What a job program with streamed motion says that it can do."""
    usual = StreamOffer()
    written = {
        "travel_mm": robot.stream_travel_mm,
        "travel_deg": robot.stream_travel_deg,
        "loss_ms": robot.stream_loss_ms,
    }
    return replace(usual, limits=replace(usual.limits, **written))


async def _listen(name: str, port: int, starting: Awaitable[int]) -> int:
    """Wait until a device listens; an occupied port becomes a sentence."""
    try:
        return await starting
    except OSError as error:
        if error.errno != errno.EADDRINUSE:
            raise
        raise PortTaken(
            f"port {port} of {name!r} is in use by another program, perhaps another fake cell: "
            f"end that one, or give another port in the scenario file"
        ) from error


async def run_cell(
    scenario: Scenario, seed: int, ports: dict[str, int], gentl: Path | None = None
) -> int:
    """Run a cell until SIGINT or SIGTERM; prints one line of JSON when everything listens.

    Returns the exit code: 1 when a port is taken. Arguments are those of ``Cell``.
    """
    cell = Cell(scenario, seed, ports, gentl)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, cell.stopping.set)
    try:
        listening = await cell.start()
        apart = stand_apart()  # last: the render workers must not inherit it
        _announce({"ready": True, "seed": seed, "ports": listening, "real_time": apart})
        await cell.run()
    except OSError as error:
        _announce({"ready": False, "error": str(error)})
        return 1
    finally:
        await cell.stop()
    return 0


def _announce(message: dict[str, Any], write: Callable[[str], Any] = sys.stdout.write) -> None:
    write(json.dumps(message) + "\n")
    sys.stdout.flush()
