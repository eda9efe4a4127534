"""Holds the taught poses of each robot against the bounds that its driver's settings give."""

from collections.abc import Iterator, Sequence

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.errors.robot import TargetOutOfBounds


def taught_pose_issues(cell: CellConfig, found: Sequence[ConfigIssue]) -> Iterator[ConfigIssue]:
    """Taught poses at which the arm may not stand; ``found`` is what is wrong with the drivers."""
    for name, robot in cell.robots.items():
        # Settings that are wrong themselves give no bounds.
        if not any(issue.key.startswith(f"robots.{name}.") for issue in found):
            yield from _issues(name, robot)
            yield from _way_issues(name, robot)


def _way_issues(name: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    """Ways between poses that do not exist, and points at which the arm may not stand."""
    driver, settings = robot_driver(robot)
    for index, way in enumerate(robot.ways):
        key = f"robots.{name}.ways.{index}"
        for end in {way.start, way.end} - robot.poses_deg.keys():
            known = ", ".join(robot.poses_deg) or "none"
            yield ConfigIssue(key, repr(end), f"a taught pose of this robot: {known}")
        for joints_deg in way.via_deg:
            try:
                driver.check_joint_target(settings, np.radians(joints_deg))
            except TargetOutOfBounds as fault:
                text = str(list(joints_deg))
                yield ConfigIssue(f"{key}.via_deg", text, fault.detail, fault.number)


def _issues(name: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    driver, settings = robot_driver(robot)
    for pose, joints_deg in robot.poses_deg.items():
        try:
            driver.check_joint_target(settings, np.radians(joints_deg))
        except TargetOutOfBounds as fault:
            allowed = f"{fault.detail}; teach the pose again, or correct the bounds"
            key = f"robots.{name}.poses_deg.{pose}"
            yield ConfigIssue(key, str(list(joints_deg)), allowed, fault.number)
