"""The fake cell as one process: the world on the wall clock, its devices on their sockets."""

import asyncio
import json
import signal
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

from fakes.control import ControlServer
from fakes.faults import FaultBoard
from fakes.operator import Operator
from fakes.scenario import HeadName, Robot, RobotName, Scenario
from fakes.wire.sjl_controller import SjlController
from fakes.wire.sri_box import SriBox
from fakes.wire.target_server import TargetServer
from fakes.world.targets import SeenTarget
from fakes.world.world import World

_ADVANCE_S = 0.002


class Cell:
    """World and devices. ``start`` returns the ports; ``run`` lets the time pass."""

    def __init__(self, scenario: Scenario, seed: int, ports: dict[str, int] | None = None) -> None:
        self._scenario = scenario
        self._ports = ports or {}
        self._started_s = time.monotonic()
        self.world = World(scenario, seed)
        self.robots = {
            name: self._controller(name, robot) for name, robot in scenario.robots.items()
        }
        self.sensor = SriBox(self._sample)
        self.targets = TargetServer(self._measure_targets)
        self.heads = self._frame_servers()
        self.stopping = asyncio.Event()
        self.control = ControlServer(Operator(self).handlers())

    def now_s(self) -> float:
        """Time of the world."""
        return time.monotonic() - self._started_s

    async def start(self) -> dict[str, int]:
        """Listen everywhere, let the robots look for their PC; returns the ports by name."""
        scenario, port = self._scenario, self._port
        listening = {
            "sensor": await self.sensor.start_tcp(port=port("sensor", scenario.sensor_port)),
            "large_field": await self.targets.start(
                port=port("large_field", scenario.large_field.port)
            ),
        }
        for name, server in self.heads.items():
            listening[name] = await server.start(port=port(name, scenario.heads[name].port))
        for robot in self.robots.values():
            robot.start()
        listening["control"] = await self.control.start(port=port("control", scenario.control_port))
        return listening

    async def run(self) -> None:
        """Advance the world until ``stopping`` is set."""
        while not self.stopping.is_set():
            self.world.advance(self.now_s())
            await asyncio.sleep(_ADVANCE_S)

    async def stop(self) -> None:
        """Hang up everywhere. Idempotent."""
        self.stopping.set()
        devices = [*self.robots.values(), *self.heads.values(), self.targets, self.sensor]
        await asyncio.gather(*(device.stop() for device in [*devices, self.control]))

    def _controller(self, name: RobotName, robot: Robot) -> SjlController:
        ports = {
            channel: self._port(f"{name}.{channel}", port) for channel, port in robot.ports.items()
        }
        return SjlController(self.world.arms[name], self.now_s, ports, faults=FaultBoard(name))

    def _frame_servers(self) -> dict[HeadName, Any]:
        try:
            from fakes.wire.frame_server import FrameServer
        except ModuleNotFoundError:
            return {}
        return {
            name: FrameServer(partial(self.world.camera_scene, name))
            for name in self._scenario.heads
        }

    def _port(self, name: str, default: int) -> int:
        return self._ports.get(name, default)

    def _sample(self, monotonic_s: float) -> list[float]:
        reading: list[float] = self.world.sensor_wrench(monotonic_s - self._started_s).tolist()
        return reading

    async def _measure_targets(self, frames: int) -> tuple[SeenTarget, ...]:
        await asyncio.sleep(frames * self._scenario.large_field.frame_time_ms / 1000)
        return self.world.targets(frames)


async def run_cell(scenario: Scenario, seed: int, ports: dict[str, int]) -> None:
    """Run a cell until SIGINT or SIGTERM; prints one line of JSON when everything listens."""
    cell = Cell(scenario, seed, ports)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, cell.stopping.set)
    try:
        listening = await cell.start()
        _announce({"ready": True, "seed": seed, "ports": listening})
        await cell.run()
    finally:
        await cell.stop()


def _announce(message: dict[str, Any], write: Callable[[str], Any] = sys.stdout.write) -> None:
    write(json.dumps(message) + "\n")
    sys.stdout.flush()
