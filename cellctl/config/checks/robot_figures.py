"""Figures of a robot that its section and its driver both know."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import motion_bounds, robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM

_SAME_MM = 0.01
_SAME_RATIO = 1e-9
"""Bounds went through SI and back."""


def robot_issues(cell: CellConfig, bad: set[str]) -> Iterator[ConfigIssue]:
    """Speeds and loads beyond the driver's bounds, more speed in Maintenance, two kinematics.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, robot in cell.robots.items():
        yield from _maintenance(f"robots.{name}", robot)
        if f"robots.{name}" not in bad:
            yield from _speeds(f"robots.{name}", robot)
            yield from _load(f"robots.{name}", robot)
            yield from _lengths(f"robots.{name}", robot)


def _speeds(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    bounds = motion_bounds(robot)
    most_by_key = {
        "speed_percent": (bounds.joint_speed_ratio, 100.0),
        "linear_speed_mm_s": (bounds.speed_m_s, 1 / MM),
        "linear_acceleration_mm_s2": (bounds.acceleration_m_s2, 1 / MM),
    }
    for key, (bound, units) in most_by_key.items():
        value = getattr(robot, key)
        if bound is not None and value > bound * units * (1 + _SAME_RATIO):
            # The driver would refuse the first move; that is too late to hear of it.
            allowed = f"at most {bound * units:g}, by the bounds in {path}.settings"
            yield ConfigIssue(f"{path}.{key}", f"{value:g}", allowed)


def _load(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    most_kg = motion_bounds(robot).load_kg
    if robot.load is None or most_kg is None or robot.load.mass_kg <= most_kg:
        return
    allowed = f"at most {most_kg:g}, which is all that arms of this driver carry"
    yield ConfigIssue(f"{path}.load.mass_kg", f"{robot.load.mass_kg:g}", allowed)


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
    driver, settings = robot_driver(robot)
    chain = driver.chain(settings)
    if chain is None:
        return
    _, d1_m, a1_m, _ = chain.dh[0]
    for key, length in (("d1_mm", d1_m / MM), ("a1_mm", a1_m / MM)):
        value = getattr(robot, key)
        if value is not None and abs(value - length) > _SAME_MM:
            allowed = f"{length:g}, as the first link of the arm in {path}.settings has it"
            yield ConfigIssue(f"{path}.{key}", f"{value:g}", allowed)
