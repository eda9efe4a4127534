"""Figures of a robot that its section and the settings of its driver both hold.

A driver that bounds speeds has ``max_speed_mm_s``, ``max_acceleration_mm_s2`` and
``max_joint_speed_percent``; one that knows its kinematics has ``dh``, rows of angle (deg), d (mm),
a (mm) and twist (deg).
"""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.robot_drivers import robot_driver

_BOUNDED = {
    "speed_percent": "max_joint_speed_percent",
    "linear_speed_mm_s": "max_speed_mm_s",
    "linear_acceleration_mm_s2": "max_acceleration_mm_s2",
}
_SAME_MM = 0.01


def robot_issues(cell: CellConfig, bad: set[str]) -> Iterator[ConfigIssue]:
    """Speeds beyond the driver's bounds, or faster in Maintenance, and two kinematics of one arm.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, robot in cell.robots.items():
        yield from _maintenance(f"robots.{name}", robot)
        if f"robots.{name}" not in bad:
            yield from _speeds(f"robots.{name}", robot)
            yield from _lengths(f"robots.{name}", robot)


def _speeds(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    _, settings = robot_driver(robot)
    for key, bound in _BOUNDED.items():
        most, value = getattr(settings, bound, None), getattr(robot, key)
        if most is not None and value > most:
            # The driver would refuse the first move; that is too late to hear of it.
            yield ConfigIssue(f"{path}.{key}", f"{value:g}", f"at most {bound} = {most:g}")


def _maintenance(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    slow = robot.in_maintenance
    if slow is None:
        return
    for key in ("speed_percent", "linear_speed_mm_s"):
        most, value = getattr(robot, key), getattr(slow, key)
        if value > most:
            # Whoever writes it expects the arm to be so fast; in no mode is it.
            yield ConfigIssue(f"{path}.in_maintenance.{key}", f"{value:g}", f"at most {most:g}")


def _lengths(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    _, settings = robot_driver(robot)
    table = getattr(settings, "dh", None)
    if table is None:
        return
    for key, length in (("d1_mm", table[0][1]), ("a1_mm", table[0][2])):
        value = getattr(robot, key)
        if value is not None and abs(value - length) > _SAME_MM:
            allowed = f"{length:g}, as the first row of {path}.settings.dh has it"
            yield ConfigIssue(f"{path}.{key}", f"{value:g}", allowed)
