"""The devices and services of one cell, built from its file and connected together."""

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path

from scipy.spatial.transform import RigidTransform

from cellctl import log, plugins
from cellctl.cell.gather import together
from cellctl.cell.stereo_station import HeadStation
from cellctl.config import CellConfig
from cellctl.config.devices import Device
from cellctl.errors import CellError
from cellctl.errors.link import ConnectTimeout
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import GuardSettings
from cellctl.interfaces import Robot, StereoCamera, TargetTracker
from cellctl.workers import VisionWorkers

_log = log.get(__name__)

LINK_AGE_S = 1.0
"""A robot silent for this long is reported even while nothing moves."""


class Cell:
    """All devices. Built without I/O; ``connect`` names every device that fails, not the first."""

    def __init__(self, config: CellConfig, folder: Path) -> None:
        self.config = config
        self.folder = folder
        robots = config.robots
        self.main: Robot = _build(plugins.ROBOT, "main", robots.main)
        self.aux_1: Robot = _build(plugins.ROBOT, "aux_1", robots.aux_1)
        self.aux_2: Robot = _build(plugins.ROBOT, "aux_2", robots.aux_2)
        camera_1: StereoCamera = _build(plugins.STEREO_CAMERA, "head_1", config.heads.head_1)
        camera_2: StereoCamera = _build(plugins.STEREO_CAMERA, "head_2", config.heads.head_2)
        self.head_1 = HeadStation("head_1", camera_1, self.aux_1, robots.aux_1)
        self.head_2 = HeadStation("head_2", camera_2, self.aux_2, robots.aux_2)
        self.tracker: TargetTracker = _build(plugins.TARGET_TRACKER, "tracker", config.tracker)
        force = config.force
        self.guard = GuardClient(
            force.sensor.driver,
            force.sensor.settings,
            force.stop_channel.driver,
            force.stop_channel.settings,
            GuardSettings(
                flange_T_sensor=pose_from_xyzabc(robots.main.flange_T_sensor), cpu=force.cpu
            ),
        )
        self.workers = VisionWorkers()
        self.connected = False
        """True from a ``connect`` that reached every device until ``disconnect``."""
        self.unanswered: dict[str, CellError] = {}
        """Heads and tracker that did not answer when they were asked last."""
        self.base_T_frame: RigidTransform | None = None
        """The frame as measured last: only for leaving the station straight."""
        self.awaits_trips = False
        """True while a move deals with the trips of the guard itself."""

    @property
    def heads(self) -> tuple[HeadStation, HeadStation]:
        """Head I and head II."""
        return self.head_1, self.head_2

    @property
    def robots(self) -> tuple[Robot, Robot, Robot]:
        """Main, auxiliary 1, auxiliary 2."""
        return self.main, self.aux_1, self.aux_2

    def health_checks(self) -> dict[str, Callable[[], object]]:
        """A call for each device that raises its fault when it is not well; none of them blocks."""
        checks: dict[str, Callable[[], object]] = {
            f"robots.{robot.name}": partial(robot.state, LINK_AGE_S) for robot in self.robots
        }
        checks["guard"] = self.guard.check
        return checks

    async def ask_heads_and_tracker(self) -> None:
        """Have each of them answer; fills ``unanswered``. Not while a run uses them."""
        devices = {head.name: head.camera for head in self.heads} | {"tracker": self.tracker}
        answers = await asyncio.gather(
            *(device.serial_number() for device in devices.values()), return_exceptions=True
        )
        self.unanswered = {}
        for name, answer in zip(devices, answers, strict=True):
            if isinstance(answer, CellError):
                self.unanswered[name] = answer
            elif isinstance(answer, BaseException):
                raise answer

    async def connect(self) -> None:
        """Connect everything at once, or nothing; raises one fault that names every failing device.

        May be tried again.
        """
        try:
            await _all(
                {
                    "guard": self.guard.start(),
                    "robots.main": self.main.connect(),
                    "robots.aux_1": self.aux_1.connect(),
                    "robots.aux_2": self.aux_2.connect(),
                    "heads.head_1": self.head_1.camera.connect(),
                    "heads.head_2": self.head_2.camera.connect(),
                    "tracker": self.tracker.connect(),
                }
            )
        except BaseException:
            await self.disconnect()
            raise
        self.connected, self.unanswered = True, {}
        _log.info("all devices connected", simulated=self.config.simulated)

    async def disconnect(self) -> None:
        """Stop the robots and drop all links; errors are logged, nothing is skipped."""
        self.connected = False
        results = await asyncio.gather(
            *(robot.disconnect() for robot in self.robots),
            *(head.camera.disconnect() for head in self.heads),
            self.tracker.disconnect(),
            self.guard.stop(),
            return_exceptions=True,
        )
        for result in results:
            if isinstance(result, BaseException):
                _log.warning("while disconnecting", error=str(result))

    async def stop_motion(self) -> None:
        """Stop and latch all robots at once, then let the guard watch no more force limits.

        Raises the first fault after trying all; a guard that does not answer is only logged, its
        own supervision reports it. Does nothing while nothing is connected: whoever drops a link to
        a robot has it stopped.
        """
        if not self.connected:
            return
        results = await asyncio.gather(
            *(robot.stop() for robot in self.robots), return_exceptions=True
        )
        try:
            await self.guard.disarm()
        except CellError as error:
            _log.warning("guard not disarmed", fault=str(error))
        failures = [result for result in results if isinstance(result, BaseException)]
        for second in failures[1:]:
            failures[0].add_note(f"beside it: {second}")
        if failures:
            raise failures[0]

    async def rearm(self) -> None:
        """Release the stop latches of guard and robots; moves nothing."""
        await self.guard.acknowledge()
        await together(*(robot.rearm() for robot in self.robots))


def _build(group: str, name: str, device: Device):  # type: ignore[no-untyped-def]
    """A driver object; its settings were validated when the cell file was loaded."""
    driver = plugins.load(group, device.driver)
    return driver(name, driver.Config.model_validate(device.settings))  # type: ignore[attr-defined]


async def _all(attempts: dict[str, Awaitable[None]]) -> None:
    results = await asyncio.gather(*attempts.values(), return_exceptions=True)
    failed = {
        name: result
        for name, result in zip(attempts, results, strict=True)
        if isinstance(result, BaseException)
    }
    for name, error in failed.items():
        _log.error("device failed to connect", device=name, error=str(error))
    unexpected = [error for error in failed.values() if not isinstance(error, CellError)]
    if unexpected:
        raise unexpected[0]
    if len(failed) == 1:
        raise next(iter(failed.values()))
    if failed:
        raise ConnectTimeout("; ".join(f"{name}: {error}" for name, error in failed.items()))
