"""Builds the devices of the cell file, connects and disconnects them, and stops all motion."""

import asyncio
from collections.abc import Callable, Coroutine, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from cellctl import log
from cellctl.cell.driver_object import drivers_of
from cellctl.cell.gather import gather_named, gather_or_cancel
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.cell.lighting.lit_cameras import Lights
from cellctl.cell.patience.patient_devices import (
    PatientCamera,
    PatientGripper,
    PatientHead,
    PatientIo,
    PatientTracker,
)
from cellctl.cell.patience.patient_robot import patient_robot
from cellctl.cell.robot_layers.noted_robot import RobotNotes
from cellctl.cell.robot_layers.permitted_robot import permitted
from cellctl.cell.robot_layers.slowed_robot import MaintenancePace, slowed
from cellctl.cell.run_notes import RunNotes
from cellctl.cell.silent_devices import unanswered
from cellctl.cell.stereo_station import StereoStation
from cellctl.cell.time_limits import USUAL, TimeLimits
from cellctl.cell.zones.zoned_robot import zoned_robots
from cellctl.config import CellConfig
from cellctl.config.devices import ForceSensorConfig
from cellctl.errors import CellError
from cellctl.errors.robot import StopFailed
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import GuardSettings
from cellctl.interfaces.device import Device
from cellctl.workers import VisionWorkers

_log = log.get(__name__)

LINK_AGE_S = 1.0
"""A robot silent for this long is reported even while nothing moves."""


class Cell:
    """All devices by name. Built without I/O; ``connect`` names every device that fails."""

    def __init__(self, config: CellConfig, folder: Path, time_limits: TimeLimits = USUAL) -> None:
        """``folder`` holds the cell file."""
        self.time_limits, self.config, self.folder = time_limits, config, folder
        self.zero_folder: Path | None = None
        """Where zeros of parts in their places outlive the process; the daemon sets it."""
        self.robot_notes = RobotNotes()
        self.run_notes = RunNotes()
        self.digital_ios = drivers_of(config, "digital_ios", PatientIo)
        # The layers of a robot, from the driver outwards. Their order matters: patience bounds the
        # driver alone; what is noted is what was sent, after it was slowed; and a move that waits
        # for its zone has reached none of them, so that no time runs and nothing is noted yet.
        built = [
            permitted(config, one, self.digital_ios)
            for one in drivers_of(config, "robots", patient_robot).values()
        ]
        noted = map(self.robot_notes.noted, built)
        self.pace = MaintenancePace()
        moving = slowed(config, {robot.name: robot for robot in noted}, self.pace)
        self.robots = zoned_robots(config, moving)
        lights = Lights(self.digital_ios)
        heads = drivers_of(config, "stereo_cameras", PatientHead)
        self.stereo_cameras = lights.heads(heads, config.stereo_cameras)
        cameras = drivers_of(config, "cameras", PatientCamera)
        self.cameras = lights.cameras(cameras, config.cameras)
        self.trackers = drivers_of(config, "trackers", PatientTracker)
        self.grippers = drivers_of(config, "grippers", PatientGripper)
        self.guards = {name: _guard(sensor) for name, sensor in config.force_sensors.items()}
        """Guards by the name of the force sensor that each of them owns."""
        self.workers = VisionWorkers()
        self.connected = False
        """True from a ``connect`` that reached every device until ``disconnect``."""
        self.unanswered: dict[str, CellError] = {}
        """Devices that did not answer when they were asked last."""
        self.unstopped: dict[str, BaseException] = {}
        """Robots that did not confirm their last stop, until a ``connect`` that reached every
        device. They may still move."""
        self._awaited_trips: set[str] = set()

    def stereo_station(self, name: str) -> StereoStation:
        """A stereo head that a robot carries; the check of the cell file saw to it that one does.

        Raises ``KeyError`` for an unknown head.
        """
        camera = self.config.stereo_cameras[name]
        carrier = camera.carried_by or ""
        return StereoStation(
            name,
            self.stereo_cameras[name],
            camera,
            self.robots[carrier],
            self.config.robots[carrier],
        )

    def guarded_robot(self, name: str) -> GuardedRobot:
        """The robot that carries this force sensor; raises ``KeyError`` for an unknown one."""
        sensor, folder = self.config.force_sensors[name], self.zero_folder
        carrier, zero_file = sensor.mounted_on, folder and folder / f"{name}.json"
        return GuardedRobot(
            self.robots[carrier],
            self.config.robots[carrier],
            name,
            self.guards[name],
            sensor,
            zero_file,
        )

    @contextmanager
    def trips_awaited(self, sensor_name: str) -> Iterator[None]:
        """Inside, whoever moves deals with the trips of this guard; supervision leaves them."""
        # A touch is a trip that a guarded move is made to find. Supervision would take it for a
        # fault and abort the run.
        self._awaited_trips.add(sensor_name)
        try:
            yield
        finally:
            self._awaited_trips.discard(sensor_name)

    def awaits_trips(self, sensor_name: str) -> bool:
        """True while a move deals with the trips of this guard itself."""
        return sensor_name in self._awaited_trips

    def health_checks(self) -> dict[str, Callable[[], object]]:
        """A call for each device that raises its fault when it is not well; none of them blocks."""
        checks: dict[str, Callable[[], object]] = {
            f"robots.{name}": partial(robot.state, LINK_AGE_S)
            for name, robot in self.robots.items()
        }
        checks |= {f"force_sensors.{name}": guard.check for name, guard in self.guards.items()}
        return checks

    def incidents(self) -> list[CellError]:
        """What the drivers have noticed beside their work since the last call."""
        return [one for device in self._by_path().values() for one in device.incidents()]

    async def ask_silent_devices(self) -> None:
        """Have each device answer that reports nothing by itself; fills ``unanswered``.

        Not while a run uses them: a camera answers one request at a time.
        """
        questions: dict[str, Coroutine[Any, Any, object]] = {
            name: device.serial_number()
            for devices in (self.stereo_cameras, self.cameras, self.trackers)
            for name, device in devices.items()
        }
        questions |= {name: gripper.state() for name, gripper in self.grippers.items()}
        questions |= {name: io.read() for name, io in self.digital_ios.items()}
        self.unanswered = await unanswered(questions, self.time_limits.ask_s)

    async def connect(self) -> None:
        """Connect everything at once, or nothing; raises one fault that names every failing device.

        Raises ``StopFailed``, with the links open, while an arm that did not confirm its last stop
        reports that it moves. May be tried again.
        """
        try:
            await gather_named(
                {f"force_sensors.{name}": guard.start() for name, guard in self.guards.items()}
                | {path: device.connect() for path, device in self._by_path().items()}
            )
        except BaseException:
            # Devices that did connect are let go again, because the next attempt connects all of
            # them and has to find their ports free.
            await self.disconnect()
            raise
        # Not cleared before every device has answered: until then an arm that did not confirm its
        # stop may still move.
        self.connected, self.unanswered = True, {}
        # Whoever clears says that the arms stand. Their controllers know it, and are asked too.
        moving = [name for name in self.unstopped if self.robots[name].state().moving]
        self.unstopped = {name: StopFailed(f"{name} still moves") for name in moving}
        if moving:
            raise self.unstopped[moving[0]]
        _log.info("all devices connected", simulated=self.config.simulated)

    async def disconnect(self) -> None:
        """Stop the robots and drop all links; errors are logged, nothing is skipped."""
        self.connected = False
        results = await asyncio.gather(
            *(device.disconnect() for device in self._by_path().values()),
            *(guard.stop() for guard in self.guards.values()),
            return_exceptions=True,
        )
        # Whatever fails here is only logged. A link that cannot be closed in order is lost to the
        # robot too, and it stops for that.
        for result in results:
            if isinstance(result, BaseException):
                _log.warning("while disconnecting", error=str(result))

    async def stop_motion(self) -> None:
        """Stop and latch all robots at once, and those with a guard over its channel as well.

        A guard watches no more force limits once its robot stands; that of a robot which does not
        confirm the stop goes on. Raises the first fault of a robot after trying all, and names
        those robots in ``unstopped``; a guard that does not answer is only logged, its own
        supervision reports it. Does nothing while nothing is connected: whoever drops a link to a
        robot has it stopped.
        """
        if not self.connected:
            return
        # All requests leave in the first turn of these tasks, those of the robots first.
        stops = [asyncio.create_task(robot.stop()) for robot in self.robots.values()]
        second_stops = [asyncio.create_task(guard.stop_robot()) for guard in self.guards.values()]
        try:
            if stops:
                await asyncio.wait(stops)
        finally:
            # Set before anything is awaited again, and also when the caller gives up a driver that
            # hangs: the line must see that an arm may still move.
            self.unstopped = {
                name: fault
                for name, stop in zip(self.robots, stops, strict=True)
                if (fault := _unconfirmed(name, stop)) is not None
            }
            for stop in stops:
                stop.cancel()
        for name, result in zip(
            self.guards, await asyncio.gather(*second_stops, return_exceptions=True), strict=True
        ):
            if isinstance(result, BaseException):
                _log.warning("guard did not take the stop", guard=name, fault=str(result))
        await self._disarm_where_robots_stand()
        failures = list(self.unstopped.values())
        # One fault leads the machine, but whoever walks to the cell has to know of every arm that
        # may still move.
        for second in failures[1:]:
            failures[0].add_note(f"beside it: {second}")
        if failures:
            raise failures[0]

    async def _disarm_where_robots_stand(self) -> None:
        for name, guard in self.guards.items():
            # The guard of such a robot is the only one that still asks it to stop.
            if self.config.force_sensors[name].mounted_on in self.unstopped:
                continue
            try:
                await guard.disarm()
            except CellError as error:
                _log.warning("guard not disarmed", fault=str(error))

    async def rearm(self) -> None:
        """Release the stop latches of guards and robots; moves nothing."""
        # The guards first: one that still wants a stop would ask again as soon as its robot is
        # released.
        for guard in self.guards.values():
            await guard.acknowledge()
        # A cell without a robot has nothing to rearm, and gather needs at least one task.
        if self.robots:
            await gather_or_cancel(*(robot.rearm() for robot in self.robots.values()))

    def _by_path(self) -> dict[str, Device]:
        """Every device of the event loop by its path in the cell file."""
        sections: Mapping[str, Mapping[str, Device]] = {
            "robots": self.robots,
            "stereo_cameras": self.stereo_cameras,
            "cameras": self.cameras,
            "trackers": self.trackers,
            "grippers": self.grippers,
            "digital_ios": self.digital_ios,
        }
        return {
            f"{section}.{name}": device
            for section, devices in sections.items()
            for name, device in devices.items()
        }


def _guard(sensor: ForceSensorConfig) -> GuardClient:
    return GuardClient(
        sensor.driver,
        sensor.settings,
        sensor.stop_channel.driver,
        sensor.stop_channel.settings,
        GuardSettings(flange_T_sensor=pose_from_xyzabc(sensor.flange_T_sensor), cpu=sensor.cpu),
    )


def _unconfirmed(name: str, stop: "asyncio.Task[None]") -> BaseException | None:
    if not stop.done() or stop.cancelled():
        return StopFailed(f"{name}: its driver has not come back from the stop")
    return stop.exception()
