"""The devices of a fake cell that listen: one server for each section of the scenario file.

Job controllers of robots are not here: they connect to the PC, as the real ones do.
"""

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol, TypeVar

from fakes.clock import WorldClock
from fakes.faults import TRACKER_FAULTS, FaultBoard
from fakes.render.look import options_of
from fakes.render.options import RenderOptions
from fakes.render.worker import make_pool, render_frame
from fakes.scenario import Scenario
from fakes.sections import DigitalIo, Gripper, Robot, SingleCamera, StereoCamera, Tracker
from fakes.wire.cameras.cfs_server import MONO8, RGB8, CfsServer, ExposureError
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.image_server import ImageServer, Picture
from fakes.wire.cameras.target_server import TargetServer
from fakes.wire.couplers.coupler import CouplerServer
from fakes.wire.couplers.gripper_coupler import gripper_coupler
from fakes.wire.duco.controller import DucoController
from fakes.wire.duco.logic import DucoLogic
from fakes.wire.sri.box import SriBox
from fakes.world.targets import SeenTarget
from fakes.world.world import Command, World

HOST = "127.0.0.1"
T = TypeVar("T")


class DeviceFaults(Protocol):
    """The faults of a device that keeps them itself."""

    def inject(self, name: str, *arguments: Any, **parameters: Any) -> None:
        """Switch a fault on; ``ValueError`` for a name that does not exist."""

    def clear(self) -> None:
        """Switch all faults off."""


@dataclass(frozen=True, slots=True)
class Device:
    """A server of the fake cell."""

    name: str
    port: int
    """Where it shall listen; 0 for any free port."""
    faults: FaultBoard | DeviceFaults
    start: Callable[[], Awaitable[int]]
    """Listens and returns the port; ``OSError`` when it is taken."""
    stop: Callable[[], Awaitable[None]]


class DeviceRack:
    """Every listening device of a scenario, wired to the world."""

    def __init__(self, world: World[Any], clock: WorldClock, ports: Mapping[str, int]) -> None:
        """``clock`` is that of the world; ``ports`` override those of the scenario."""
        self._scenario: Scenario = world.scenario
        self._world, self._clock, self._ports = world, clock, ports
        self._renderers: ProcessPoolExecutor | None = None
        self._inputs: dict[str, dict[int, bool]] = {}
        self._couplers: dict[str, CouplerServer] = {}
        self.devices = {device.name: device for device in self._all()}

    def commands(self) -> Mapping[str, Command]:
        """What the hands of an operator do at these devices."""
        commands: dict[str, Command] = {}
        if self._world.jaws:
            commands["set_part"] = self._set_part
        if self._couplers:
            commands |= {"set_input": self._set_input, "outputs": self._outputs}
        return commands

    def shut_down(self) -> None:
        """End the renderers, once the devices have stopped."""
        if self._renderers is not None:
            self._renderers.shutdown(cancel_futures=True)

    def _all(self) -> Iterator[Device]:
        scenario = self._scenario
        for name, robot in scenario.robots.items():
            if robot.controller == "rpc":
                yield self._collaborative_arm(name, robot)
        for name in scenario.force_sensors:
            yield self._force_sensor(name)
        for name, tracker in scenario.trackers.items():
            yield self._tracker(name, tracker)
        for name, head in scenario.stereo_cameras.items():
            yield self._stereo_camera(name, head)
        for name, camera in scenario.cameras.items():
            yield self._camera(name, camera)
        for name, gripper in scenario.grippers.items():
            yield self._gripper(name, gripper)
        for name, io in scenario.digital_ios.items():
            yield self._digital_io(name, io)

    def _port(self, name: str, default: int) -> int:
        return self._ports.get(name, default)

    # -- robots ---------------------------------------------------------------------------------
    def _collaborative_arm(self, name: str, robot: Robot) -> Device:
        controller = DucoController(
            DucoLogic(self._world.arms[name], self._clock),
            rpc_port=self._port(f"{name}.RPC", robot.ports["RPC"]),
            state_port=self._port(f"{name}.FRAMES", robot.ports["FRAMES"]),
        )

        async def start() -> int:
            await controller.start()
            return controller.rpc_port

        return Device(name, controller.rpc_port, controller.logic.faults, start, controller.stop)

    # -- force sensors and trackers -------------------------------------------------------------
    def _force_sensor(self, name: str) -> Device:
        def sample(time_s: float) -> list[float]:
            reading: list[float] = self._world.sensor_wrench(name, time_s).tolist()
            return reading

        box = SriBox(sample, clock=self._clock)
        port = self._port(name, self._scenario.force_sensors[name].port)
        return Device(name, port, box.faults, partial(box.start_tcp, port=port), box.stop)

    def _tracker(self, name: str, tracker: Tracker) -> Device:
        async def measure(frames: int) -> tuple[SeenTarget, ...]:
            await asyncio.sleep(frames * tracker.frame_time_ms / 1000)
            return self._world.targets(name, frames)

        faults = FaultBoard(name, TRACKER_FAULTS)
        server = TargetServer(measure, serial=tracker.serial, faults=faults)
        port = self._port(name, tracker.port)
        return Device(name, port, faults, partial(server.start, port=port), server.stop)

    # -- cameras --------------------------------------------------------------------------------
    def _stereo_camera(self, name: str, camera: StereoCamera) -> Device:
        port = self._port(name, camera.port)
        server = FrameServer(
            HOST,
            port,
            partial(self._world.camera_scene, name),
            self._pool(),
            options=self._look(),
            identity=f"fake-head;{camera.serial};1.0",
            exposure_us=self._scenario.optics[camera.optics].exposure_us,
        )
        return _frame_device(name, port, server)

    def _camera(self, name: str, camera: SingleCamera) -> Device:
        pool, options = self._pool(), self._look()

        async def take(faults: frozenset[str]) -> Picture:
            scene = self._world.camera_scene(name)
            loop = asyncio.get_running_loop()
            try:
                frame = await loop.run_in_executor(pool, render_frame, scene, options, faults)
            except BrokenExecutor as error:
                raise ExposureError(str(error)) from error
            pixel_format = RGB8 if camera.colour else MONO8
            return Picture(frame.width, frame.height, frame.payload, scene.time_s, pixel_format)

        port = self._port(name, camera.port)
        server = ImageServer(
            HOST,
            port,
            take,
            identity=f"fake-camera;{camera.serial};1.0",
            exposure_us=self._scenario.optics[camera.optics].exposure_us,
        )
        return _frame_device(name, port, server)

    def _look(self) -> RenderOptions:
        rendering = self._scenario.rendering
        assert rendering is not None  # the scenario's model demands it where there is a camera
        return options_of(
            rendering,
            glare=self._scenario.size_of("glare"),
            tilt_shading=self._scenario.size_of("tilt_shading"),
        )

    def _pool(self) -> ProcessPoolExecutor:
        """One renderer for all cameras; a cell without cameras does without."""
        if self._renderers is None:
            self._renderers = make_pool()
        return self._renderers

    # -- couplers -------------------------------------------------------------------------------
    def _gripper(self, name: str, gripper: Gripper) -> Device:
        jaws = self._world.jaws[name]
        coupler = gripper_coupler(jaws, self._clock, watchdog_ms=gripper.watchdog_ms)
        return self._coupler(name, gripper.port, coupler)

    def _digital_io(self, name: str, io: DigitalIo) -> Device:
        inputs = {**dict.fromkeys(io.inputs_on, True), **dict.fromkeys(io.inputs_off, False)}
        self._inputs[name] = inputs
        coupler = CouplerServer(
            self._clock,
            inputs=lambda _time_s: inputs,
            output_addresses=io.outputs,
            watchdog_ms=io.watchdog_ms,
        )
        return self._coupler(name, io.port, coupler)

    def _coupler(self, name: str, default_port: int, coupler: CouplerServer) -> Device:
        self._couplers[name] = coupler
        port = self._port(name, default_port)
        return Device(name, port, coupler.faults, partial(coupler.start, port=port), coupler.stop)

    # -- hands of the operator ------------------------------------------------------------------
    def _set_part(self, gripper: str, present: bool) -> None:  # noqa: FBT001  by its name only
        """Put a part between the jaws, or take it away."""
        _known(self._world.jaws, gripper).part_present = present

    def _set_input(self, device: str, address: int, on: bool) -> None:  # noqa: FBT001  likewise
        """Switch an input of a digital I/O."""
        inputs = _known(self._inputs, device)
        if address not in inputs:
            raise ValueError(f"{device} has no input {address}; it has {sorted(inputs)}")
        inputs[address] = on

    def _outputs(self, device: str) -> dict[str, Any]:
        """Outputs as they are driven now, by address."""
        return {"outputs": _known(self._couplers, device).outputs}


def _frame_device(name: str, port: int, server: CfsServer) -> Device:
    async def start() -> int:
        await server.start()
        return server.port

    return Device(name, port, server.faults, start, server.stop)


def _known(devices: Mapping[str, T], name: str) -> T:
    if name not in devices:
        raise ValueError(f"unknown device {name!r}; known: {sorted(devices)}")
    return devices[name]
