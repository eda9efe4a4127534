"""The points of a stated way that a joint move to a taught pose still has before it."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cellctl.config.devices import RobotConfig, WayConfig
from cellctl.geometry.pose import Array

ON_WAY_RAD = float(np.radians(0.5))
"""Joints this near a way count as on it: an abort may leave the arm anywhere on it."""


def via_points(robot: RobotConfig, here_rad: Array, pose: str) -> list[Array]:
    """Joints, each of shape (6,), from joints of shape (6,) to a taught pose, its own left out.

    Empty where the file states no way on which the arm is: then it goes straight.
    """
    for way in robot.ways:
        if way.end == pose:
            points = way_points(robot, way)
            for number, (start_rad, end_rad) in enumerate(pairwise(points), start=1):
                if _off_line(here_rad, start_rad, end_rad) <= ON_WAY_RAD:
                    return list(points[number:-1])
    return []


def has_way(robot: RobotConfig, start: str, end: str) -> bool:
    """Whether the file states a way between these poses."""
    return any(way.start == start and way.end == end for way in robot.ways)


def way_points(robot: RobotConfig, way: WayConfig) -> Sequence[Array]:
    """Both ends of a way and all points between, each of shape (6,)."""
    ends = robot.poses_deg[way.start], robot.poses_deg[way.end]
    return [np.radians(joints) for joints in (ends[0], *way.via_deg, ends[1])]


def _off_line(here_rad: Array, start_rad: Array, end_rad: Array) -> float:
    """The greatest difference of a joint from the nearest point of a straight line, in rad."""
    line = end_rad - start_rad
    length = float(line @ line)
    share = float(np.clip((here_rad - start_rad) @ line / length, 0.0, 1.0)) if length else 0.0
    return float(np.abs(here_rad - start_rad - share * line).max())
