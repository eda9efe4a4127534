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
from fakes.priority import stand_apart
from fakes.render.look import options_of
from fakes.render.worker import make_pool
from fakes.scenario import Head, HeadName, Robot, RobotName, Scenario
from fakes.wire.frame_server import FrameServer
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
        self.targets = TargetServer(self._measure_targets, serial=scenario.large_field.serial)
        self._renderers = make_pool()
        self.heads = {name: self._frame_server(name, head) for name, head in scenario.heads.items()}
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
            await server.start()
            listening[name] = server.port
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
        await asyncio.gather(*(robot.stop() for robot in self.robots.values()))
        await asyncio.gather(*(head.stop() for head in self.heads.values()))
        await asyncio.gather(self.targets.stop(), self.sensor.stop(), self.control.stop())
        self._renderers.shutdown(cancel_futures=True)

    def _controller(self, name: RobotName, robot: Robot) -> SjlController:
        ports = {
            channel: self._port(f"{name}.{channel}", port) for channel, port in robot.ports.items()
        }
        return SjlController(self.world.arms[name], self.now_s, ports, faults=FaultBoard(name))

    def _frame_server(self, name: HeadName, head: Head) -> FrameServer:
        return FrameServer(
            "127.0.0.1",
            self._port(name, head.port),
            partial(self.world.camera_scene, name),
            self._renderers,
            options=options_of(self._scenario.rendering),
            identity=f"fake-head;{head.serial};1.0",
            exposure_us=self._scenario.cameras.exposure_us,
        )

    def _port(self, name: str, default: int) -> int:
        return self._ports.get(name, default)

    def _sample(self, monotonic_s: float) -> list[float]:
        reading: list[float] = self.world.sensor_wrench(monotonic_s - self._started_s).tolist()
        return reading

    async def _measure_targets(self, frames: int) -> tuple[SeenTarget, ...]:
        await asyncio.sleep(frames * self._scenario.large_field.frame_time_ms / 1000)
        return self.world.targets(frames)


async def run_cell(scenario: Scenario, seed: int, ports: dict[str, int]) -> int:
    """Run a cell until SIGINT or SIGTERM; prints one line of JSON when everything listens.

    Returns the exit code: 1 when a port is taken.
    """
    cell = Cell(scenario, seed, ports)
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
