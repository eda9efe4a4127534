"""Checks of the zones of a cell file against its robots."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.zones import ZoneShare
from cellctl.geometry.box import Box


def zone_issues(cell: CellConfig, found: Sequence[ConfigIssue]) -> Iterator[ConfigIssue]:
    """Robots and poses that do not exist, orders that contradict each other; ``found`` is what is
    wrong with the drivers."""
    yield from _retreat_issues(cell)
    robots = ", ".join(cell.robots) or "none"
    for zone, config in cell.zones.items():
        for robot, share in config.robots.items():
            key = f"zones.{zone}.robots.{robot}"
            if robot not in cell.robots:
                yield ConfigIssue(key, repr(robot), f"a robot of this cell: {robots}")
            else:
                yield from _clear_pose_issues(cell, robot, share, key)
                # Settings that are wrong themselves do not say what the driver knows.
                if not any(issue.key.startswith(f"robots.{robot}.") for issue in found):
                    yield from _needless_clear_poses(cell, robot, share, key)


def _retreat_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Robots of another zone, and two that would wait for each other, because two zones have
    them leave in two orders."""
    first: dict[tuple[str, str], str] = {}
    for zone, config in cell.zones.items():
        for robot in config.retreat:
            if robot not in config.robots:
                allowed = "a robot of this zone: " + ", ".join(config.robots)
                yield ConfigIssue(f"zones.{zone}.retreat", repr(robot), allowed)
            elif config.robots[robot].way_out is None:
                allowed = "a face of the box, as '+y', because the robot is in retreat"
                yield ConfigIssue(f"zones.{zone}.robots.{robot}.way_out", "missing", allowed)
        for earlier, later in combinations(config.retreat, 2):
            first[earlier, later] = zone
            if (other := first.get((later, earlier))) is not None:
                allowed = f"{later} before {earlier}, as in zones.{other}.retreat"
                yield ConfigIssue(f"zones.{zone}.retreat", str(list(config.retreat)), allowed)


def _clear_pose_issues(
    cell: CellConfig, robot: str, share: ZoneShare, key: str
) -> Iterator[ConfigIssue]:
    taught = cell.robots[robot].poses_deg
    for pose in share.clear_poses:
        if pose not in taught:
            allowed = "a taught pose of this robot: " + (", ".join(taught) or "none")
            yield ConfigIssue(f"{key}.clear_poses", repr(pose), allowed)


def _needless_clear_poses(
    cell: CellConfig, robot: str, share: ZoneShare, key: str
) -> Iterator[ConfigIssue]:
    driver, settings = robot_driver(cell.robots[robot])
    # Two answers to one question would let the wrong one be believed.
    if share.clear_poses and driver.forward_kinematics(settings) is not None:
        allowed = "left out: the kinematics of this robot are known, and its box decides"
        yield ConfigIssue(f"{key}.clear_poses", str(list(share.clear_poses)), allowed)


def taught_in_zone(robot: RobotConfig, share: ZoneShare) -> list[str]:
    """Taught poses that need the zone: by forward kinematics, else all that are not clear."""
    driver, settings = robot_driver(robot)
    kinematics = driver.forward_kinematics(settings)
    if kinematics is None:
        return [pose for pose in robot.poses_deg if pose not in share.clear_poses]
    box = Box.from_mm(share.min_mm, share.max_mm)
    return [
        pose
        for pose, joints_deg in robot.poses_deg.items()
        if box.holds(kinematics(np.radians(joints_deg)).translation)
    ]
