"""Roles: the devices that a process needs of a cell, by their interface."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.devices import GROUPS
from cellctl.config.issue import ConfigIssue
from cellctl.config.recipe import Recipe
from cellctl.errors.config import UnknownDriver
from cellctl.interfaces import (
    Camera,
    DigitalIo,
    FtSensor,
    Gripper,
    Robot,
    StereoCamera,
    TargetTracker,
)

SECTIONS: Mapping[type, str] = {
    Robot: "robots",
    StereoCamera: "stereo_cameras",
    Camera: "cameras",
    TargetTracker: "trackers",
    FtSensor: "force_sensors",
    Gripper: "grippers",
    DigitalIo: "digital_ios",
}
"""The section of the cell file that describes the devices of an interface."""


@dataclass(frozen=True, slots=True)
class Role:
    """A device that a process works with."""

    interface: type
    """One of ``cellctl.interfaces``; a driver may offer more than that of its section."""
    text: str
    """Its task in the process, for messages and documents."""
    poses: tuple[str, ...] = ()
    """Taught poses that the robot must have."""
    rests_at: tuple[str, ...] = ()
    """Those of them at which it stays while others work: clear of every space that arms share."""
    carried: bool = False
    """Whether a camera must be carried by a robot."""

    @property
    def section(self) -> str:
        """The section of the cell file that describes such devices."""
        return next(name for base, name in SECTIONS.items() if issubclass(self.interface, base))


def lacking(
    cell: CellConfig, roles: Mapping[str, Role], recipe: Recipe, key: str
) -> Iterator[ConfigIssue]:
    """Everything that a cell lacks for the roles of a recipe, whose place in the file is ``key``.

    Drivers that cannot be loaded are not judged here: they are reported as such.
    """
    for name in recipe.roles:
        if name not in roles:
            known = ", ".join(roles)
            yield ConfigIssue(f"{key}.roles.{name}", repr(name), f"no such role; it has: {known}")
    for name, role in roles.items():
        yield from _lacking_for(cell, role, recipe.device(name), f"{key}.roles.{name}")


def lacking_roles(cell: CellConfig, roles: Mapping[str, Role]) -> Iterator[ConfigIssue]:
    """Everything that a cell lacks for a process that has no recipe in it."""
    for name, role in roles.items():
        yield from _lacking_for(cell, role, name, name)


def arm_of(cell: CellConfig, role: Role, device: str) -> str | None:
    """The robot that is the device of a role, or that carries it; None where there is none."""
    if role.section == "robots":
        return device
    # A camera has no poses of its own: what is taught for it belongs to the robot that carries it.
    return getattr(cell.section(role.section).get(device), "carried_by", None)


def _lacking_for(cell: CellConfig, role: Role, device: str, key: str) -> Iterator[ConfigIssue]:
    found = cell.section(role.section).get(device)
    if found is None:
        allowed = f"the cell lacks [{role.section}.{device}]: {role.text}"
        yield ConfigIssue(key, "(missing)", allowed)
        return
    if not _offers(role, found.driver):
        allowed = f"{role.section}.{device} must offer {role.interface.__name__}: {role.text}"
        yield ConfigIssue(key, repr(found.driver), allowed)
    carrier = getattr(found, "carried_by", None)
    if role.carried and carrier is None:
        yield ConfigIssue(f"{role.section}.{device}.carried_by", "(missing)", "a robot carries it")
    place = arm_of(cell, role, device)
    robot = cell.robots.get(place or "")
    for pose in role.poses if robot is not None else ():
        if robot is not None and pose not in robot.poses_deg:
            allowed = f"a taught pose, in degrees ({role.text})"
            yield ConfigIssue(f"robots.{place}.poses_deg.{pose}", "(missing)", allowed)


def _offers(role: Role, driver: str) -> bool:
    try:
        return issubclass(plugins.load(GROUPS[role.section], driver), role.interface)
    except UnknownDriver:
        # Its driver cannot be loaded, which is reported as such. Whether it would offer the
        # interface is not known.
        return True
