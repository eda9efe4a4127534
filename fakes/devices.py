"""The devices of a fake cell that listen: one server for each section of the scenario file.

Job controllers of robots are not here: they connect to the PC, as the real ones do.
"""

import asyncio
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from fakes.camera_rack import CameraRack
from fakes.clock import WorldClock
from fakes.device import Device
from fakes.faults import TRACKER_FAULTS, FaultBoard
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import Contact, DigitalIo, Gripper, Robot, Tracker
from fakes.wire.cameras.target_server import TargetServer
from fakes.wire.couplers.coupler import CouplerServer
from fakes.wire.couplers.gripper_coupler import gripper_coupler
from fakes.wire.duco.controller import DucoController
from fakes.wire.duco.logic import DucoLogic
from fakes.wire.sri.box import SriBox
from fakes.world.frames import MM
from fakes.world.targets import SeenTarget
from fakes.world.world import Command, World

T = TypeVar("T")


class DeviceRack:
    """Every listening device of a scenario, wired to the world."""

    def __init__(
        self,
        world: World[Any],
        clock: WorldClock,
        ports: Mapping[str, int],
        gentl: Path | None = None,
    ) -> None:
        """``clock`` is that of the world; ``ports`` override those of the scenario.

        ``gentl`` is the file of the cameras that the fake GenTL producer shows, which is written
        anew; without one there are frame servers.
        """
        self._scenario: Scenario = world.scenario
        self._world, self._clock, self._ports = world, clock, ports
        self._cameras = CameraRack(world, ports, gentl)
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

    def contact(self, wired: Contact | None) -> Callable[[], bool]:
        """Whether a contact is closed now; one that is not wired is bridged."""
        if wired is None:
            return lambda: True
        coupler, output = self._couplers[wired.device], wired.output
        return lambda: coupler.outputs[output]

    def shut_down(self) -> None:
        """End the renderers, once the devices have stopped."""
        self._cameras.shut_down()

    def _all(self) -> Iterator[Device]:
        scenario = self._scenario
        for name, robot in scenario.robots.items():
            if robot.controller == "rpc":
                yield self._collaborative_arm(name, robot)
        for name in scenario.force_sensors:
            yield self._force_sensor(name)
        for name, tracker in scenario.trackers.items():
            yield self._tracker(name, tracker)
        yield from self._cameras.devices()
        for name, gripper in scenario.grippers.items():
            yield self._gripper(name, gripper)
        for name, io in scenario.digital_ios.items():
            yield self._digital_io(name, io)

    def _port(self, name: str, default: int) -> int:
        return self._ports.get(name, default)

    # -- robots ---------------------------------------------------------------------------------
    def _collaborative_arm(self, name: str, robot: Robot) -> Device:
        logic = DucoLogic(self._world.arms[name], self._clock)
        if robot.selected_load is not None:
            com_m = [value * MM for value in robot.selected_load.com_mm]
            logic.tool_load = [robot.selected_load.mass_kg, *com_m]
        controller = DucoController(
            logic,
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


def _known(devices: Mapping[str, T], name: str) -> T:
    if name not in devices:
        raise ValueError(f"unknown device {name!r}; known: {sorted(devices)}")
    return devices[name]
