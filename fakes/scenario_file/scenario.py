"""The scenario file of a fake cell: its devices, any number of each kind.

The key ``scene`` names what stands in the cell; that scene brings a model with further sections
(``fakes.scenes``). The key ``like`` names another scenario file in the same folder: what is not
written in this one is as it is there.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import Field, field_validator, model_validator

from fakes.imperfections import CATALOGUE, check_scales
from fakes.scenario_file.appearance import Rendering
from fakes.scenario_file.sections import (
    Camera,
    DeviceName,
    DigitalIo,
    ForceSensor,
    Gripper,
    JobController,
    Optics,
    Pose,
    Robot,
    Section,
    SingleCamera,
    StereoCamera,
    Tracker,
)
from fakes.scenario_file.written import read_written

RESERVED = ("control", "world")
"""Names on the control port and on the command line that no device may have."""
_Listening = StereoCamera | SingleCamera | Tracker | ForceSensor | Gripper | DigitalIo


class Scenario(Section):
    """What every scenario file has; the model of its scene adds the bodies."""

    scene: str
    hardware_seed: int
    """Draws the devices of the cell, which calibrations belong to."""
    control_port: int
    robots: dict[DeviceName, Robot] = Field(default_factory=dict)
    stereo_cameras: dict[DeviceName, StereoCamera] = Field(default_factory=dict)
    cameras: dict[DeviceName, SingleCamera] = Field(default_factory=dict)
    trackers: dict[DeviceName, Tracker] = Field(default_factory=dict)
    force_sensors: dict[DeviceName, ForceSensor] = Field(default_factory=dict)
    grippers: dict[DeviceName, Gripper] = Field(default_factory=dict)
    digital_ios: dict[DeviceName, DigitalIo] = Field(default_factory=dict)
    optics: dict[str, Optics] = Field(default_factory=dict)
    rendering: Rendering | None = None
    """Needed as soon as there is a camera."""
    taught: dict[DeviceName, dict[str, Pose]] = Field(default_factory=dict)
    """Flange poses in the frame of the cell, by robot and name."""
    imperfections: dict[str, float] = Field(default_factory=dict)
    """How many times its realistic size each one has, by the names of ``fakes.imperfections``.

    What is not named has the size that this file gives it, and none where the file gives no size.
    """

    @classmethod
    def read(cls, path: Path, imperfections: Mapping[str, float] | None = None) -> Self:
        """A file of this very model; scales and exceptions as with ``fakes.scenes.load.load``."""
        return cls.model_validate(read_written(path, imperfections or {}))

    def size_of(self, imperfection: str) -> float:
        """Size of an imperfection whose size is that of the catalogue, in its unit there."""
        return CATALOGUE[imperfection].size * self.imperfections.get(imperfection, 0.0)

    def with_controllers(self, controller: JobController) -> Self:
        """The same cell with one kind of controller at all arms but the collaborative ones."""
        robots = {
            name: robot
            if robot.controller == "rpc"
            else robot.model_copy(update={"controller": controller})
            for name, robot in self.robots.items()
        }
        return self.model_copy(update={"robots": robots})

    def without_imperfections(self) -> Self:
        """The same cell without those whose size is that of the catalogue."""
        return self.model_copy(update={"imperfections": {}})

    def all_cameras(self) -> dict[str, Camera]:
        """Stereo heads and single cameras by name."""
        return {**self.stereo_cameras, **self.cameras}

    def optics_of(self, camera: str) -> Optics:
        """Lens and sensor of a head or camera, nominally."""
        return self.optics[self.all_cameras()[camera].optics]

    def device_names(self) -> list[str]:
        """Every device, kind by kind."""
        return [*self.robots, *(name for kind in self._listening() for name in kind)]

    def ports(self) -> dict[str, int]:
        """Every port of the cell, by device, ``robot.CHANNEL`` or ``control``."""
        return {
            **{name: device.port for kind in self._listening() for name, device in kind.items()},
            **{
                f"{name}.{channel}": port
                for name, robot in self.robots.items()
                for channel, port in robot.ports.items()
            },
            "control": self.control_port,
        }

    def nominal_poses(self) -> dict[str, Any]:
        """Poses of the scene's bodies that an integrator writes into the cell file; JSON values."""
        return {}

    def _listening(self) -> tuple[Mapping[str, _Listening], ...]:
        """Devices that listen on a port of their own; controllers of robots connect instead."""
        return (
            self.stereo_cameras,
            self.cameras,
            self.trackers,
            self.force_sensors,
            self.grippers,
            self.digital_ios,
        )

    @model_validator(mode="after")
    def _names_fit(self) -> Self:
        if mistakes := list(self._mistakes()):
            raise ValueError("; ".join(mistakes))
        return self

    @field_validator("imperfections")
    @classmethod
    def _imperfections_are_known(cls, scales: dict[str, float]) -> dict[str, float]:
        check_scales(scales)
        return scales

    def _mistakes(self) -> Iterator[str]:
        names = self.device_names()
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield f"two devices are called {name!r}: faults and ports are found by these names"
        for name in set(names) & set(RESERVED):
            yield f"no device may be called {name!r}"
        for place, robot in self._named_robots():
            if robot not in self.robots:
                yield f"{place}: there is no robot {robot!r}"
        for name, camera in self.all_cameras().items():
            optics = self.optics.get(camera.optics)
            if optics is None:
                yield f"{name}.optics: there is no [optics.{camera.optics}]"
            elif isinstance(camera, StereoCamera) and optics.stereo is None:
                yield f"{name}.optics: [optics.{camera.optics}] has no stereo rig"
        if self.all_cameras() and self.rendering is None:
            yield "cameras need a section [rendering]"
        yield from self._robot_mistakes()

    def _robot_mistakes(self) -> Iterator[str]:
        """What an arm of its kind does not have, and contacts that are not there."""
        for name, robot in self.robots.items():
            if robot.controller != "rpc" and robot.selected_load is not None:
                yield f"{name}.selected_load: a job controller tells nobody what is selected"
            if robot.controller == "rpc" and robot.permit is not None:
                yield f"{name}.permit: the fake of a collaborative arm has no permit loop"
            contact = robot.permit
            if contact is None:
                continue
            io = self.digital_ios.get(contact.device)
            if io is None or contact.output not in io.outputs:
                there = f"output {contact.output} of a digital I/O {contact.device!r}"
                yield f"{name}.permit: there is no {there}"

    def _named_robots(self) -> Iterator[tuple[str, str]]:
        for name, camera in self.all_cameras().items():
            if camera.carried_by is not None:
                yield f"{name}.carried_by", camera.carried_by
        for name, sensor in self.force_sensors.items():
            yield f"{name}.mounted_on", sensor.mounted_on
        for name, tracker in self.trackers.items():
            yield f"{name}.targets_on", tracker.targets_on
        for robot in self.taught:
            yield f"taught.{robot}", robot
