"""The fake cell as one process: the world on the wall clock, its devices on their sockets."""

import asyncio
import errno
import json
import signal
import sys
import time
from collections.abc import Awaitable, Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

from fakes.control import ControlServer
from fakes.faults import ROBOT_FAULTS, TRACKER_FAULTS, FaultBoard
from fakes.operator import Operator
from fakes.priority import stand_apart
from fakes.render.look import options_of
from fakes.render.worker import make_pool
from fakes.scenario import Scenario
from fakes.scenes.registry import open_world
from fakes.sections import Robot, StereoCamera, Tracker
from fakes.wire.frame_server import FrameServer
from fakes.wire.sjl_controller import SjlController
from fakes.wire.sri_box import SriBox
from fakes.wire.target_server import TargetServer
from fakes.world.targets import SeenTarget

_ADVANCE_S = 0.002


class PortTaken(OSError):
    """Another program listens on a port of the fake cell."""


class Cell:
    """World and devices. ``start`` returns the ports; ``run`` lets the time pass."""

    def __init__(self, scenario: Scenario, seed: int, ports: dict[str, int] | None = None) -> None:
        """``ports`` override those of the scenario: device, ``robot.CHANNEL`` or ``control``."""
        self._scenario = scenario
        self._ports = ports or {}
        self._started_s = time.monotonic()
        self.world = open_world(scenario, seed)
        self.robots = {
            name: self._controller(name, robot) for name, robot in scenario.robots.items()
        }
        self.force_sensors = {
            name: SriBox(partial(self._sample, name)) for name in scenario.force_sensors
        }
        self.trackers = {
            name: self._target_server(name, tracker) for name, tracker in scenario.trackers.items()
        }
        self._renderers: ProcessPoolExecutor | None = None
        self.stereo_cameras = {
            name: self._frame_server(name, camera)
            for name, camera in scenario.stereo_cameras.items()
        }
        self.stopping = asyncio.Event()
        self.control = ControlServer(Operator(self).handlers())

    def now_s(self) -> float:
        """Time of the world."""
        return time.monotonic() - self._started_s

    async def start(self) -> dict[str, int]:
        """Listen everywhere, let the robots look for their PC; returns the ports by name.

        Raises ``PortTaken`` for the first device that cannot listen.
        """
        listening: dict[str, int] = {}
        for name, box in self.force_sensors.items():
            port = self._port(name, self._scenario.force_sensors[name].port)
            listening[name] = await _listen(name, port, box.start_tcp(port=port))
        for name, server in self.trackers.items():
            port = self._port(name, self._scenario.trackers[name].port)
            listening[name] = await _listen(name, port, server.start(port=port))
        for name, head in self.stereo_cameras.items():
            port = self._port(name, self._scenario.stereo_cameras[name].port)
            await _listen(name, port, head.start())
            listening[name] = head.port
        for robot in self.robots.values():
            robot.start()
        port = self._port("control", self._scenario.control_port)
        listening["control"] = await _listen("control", port, self.control.start(port=port))
        return listening

    async def run(self) -> None:
        """Advance the world until ``stopping`` is set."""
        while not self.stopping.is_set():
            self.world.advance(self.now_s())
            await asyncio.sleep(_ADVANCE_S)

    async def stop(self) -> None:
        """Hang up everywhere. Idempotent."""
        self.stopping.set()
        # Robots first: they alone connect by themselves, and would look for their PC again.
        await asyncio.gather(*(robot.stop() for robot in self.robots.values()))
        await asyncio.gather(*(head.stop() for head in self.stereo_cameras.values()))
        await asyncio.gather(*(tracker.stop() for tracker in self.trackers.values()))
        await asyncio.gather(*(box.stop() for box in self.force_sensors.values()))
        await self.control.stop()
        if self._renderers is not None:
            self._renderers.shutdown(cancel_futures=True)

    def _controller(self, name: str, robot: Robot) -> SjlController:
        ports = {
            channel: self._port(f"{name}.{channel}", port) for channel, port in robot.ports.items()
        }
        faults = FaultBoard(name, ROBOT_FAULTS)
        return SjlController(self.world.arms[name], self.now_s, ports, faults=faults)

    def _target_server(self, name: str, tracker: Tracker) -> TargetServer:
        return TargetServer(
            partial(self._measure_targets, name),
            serial=tracker.serial,
            faults=FaultBoard(name, TRACKER_FAULTS),
        )

    def _frame_server(self, name: str, camera: StereoCamera) -> FrameServer:
        rendering = self._scenario.rendering
        assert rendering is not None  # the scenario's model demands it where there is a camera
        return FrameServer(
            "127.0.0.1",
            self._port(name, camera.port),
            partial(self.world.camera_scene, name),
            self._pool(),
            options=options_of(rendering),
            identity=f"fake-head;{camera.serial};1.0",
            exposure_us=self._scenario.optics[camera.optics].exposure_us,
        )

    def _pool(self) -> ProcessPoolExecutor:
        """One renderer for all cameras; a cell without cameras does without."""
        if self._renderers is None:
            self._renderers = make_pool()
        return self._renderers

    def _port(self, name: str, default: int) -> int:
        return self._ports.get(name, default)

    def _sample(self, sensor: str, monotonic_s: float) -> list[float]:
        time_s = monotonic_s - self._started_s
        reading: list[float] = self.world.sensor_wrench(sensor, time_s).tolist()
        return reading

    async def _measure_targets(self, tracker: str, frames: int) -> tuple[SeenTarget, ...]:
        await asyncio.sleep(frames * self._scenario.trackers[tracker].frame_time_ms / 1000)
        return self.world.targets(tracker, frames)


async def _listen(name: str, port: int, starting: Awaitable[Any]) -> Any:
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
