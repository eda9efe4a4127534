"""Taught poses, ways and bounds of arms that no arm has."""

from collections.abc import Iterator, Set
from itertools import combinations
from typing import Any

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import reach_m
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM

_SAME_DEG = 0.1
"""Two poses so near in all axes are one that was copied: a name of its own means another place."""
_MOST_DEG = 360.0
"""Taught poses are bounded by it, so a wider bound bounds nothing."""
_LONGEST_REACH_MM = 6000.0
"""Longest reach of an arm whose kinematics are not known; the largest that are sold reach below 5
m."""


def arm_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Copied poses and ways, joint bounds of more than a turn, boxes beyond the reach of the arm.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, robot in cell.robots.items():
        path = f"robots.{name}"
        yield from _copied(path, robot)
        yield from _copied_ways(path, robot)
        yield from _joint_bounds(f"{path}.settings", robot.settings)
        if path not in bad:
            yield from _boxes(f"{path}.settings", robot)


def _copied(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    for (first, joints_deg), (second, others_deg) in combinations(robot.poses_deg.items(), 2):
        if np.max(np.abs(np.subtract(joints_deg, others_deg))) < _SAME_DEG:
            allowed = f"another place than {first}; these are its joints"
            yield ConfigIssue(f"{path}.poses_deg.{second}", str(list(others_deg)), allowed)


def _copied_ways(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    """A way that was copied for the way back, whose ends nobody has exchanged.

    The arm takes the first one and goes straight back, through what the way leads round.
    """
    first: dict[tuple[str, str], int] = {}
    for index, way in enumerate(robot.ways):
        ends = way.start, way.end
        if way.start == way.end:
            yield ConfigIssue(f"{path}.ways.{index}.end", repr(way.end), "another pose than start")
        elif ends in first:
            back = "" if ends[::-1] in first else f"; is it the way back, from {ends[1]!r}?"
            allowed = f"ends that no way before has; ways.{first[ends]} leads there from it{back}"
            yield ConfigIssue(f"{path}.ways.{index}.start", repr(way.start), allowed)
        first.setdefault(ends, index)


def arm_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Ways without their way back or with another one, and arrivals that are called so from far
    off."""
    for name, robot in cell.robots.items():
        yield from _ways_back(f"robots.{name}.ways", robot)
        for key, most in (("arrival_tolerance_mm", 1.0), ("arrival_tolerance_deg", 0.5)):
            value = robot.settings.get(key, 0.0)
            if value > most:
                said = (
                    f"an arm that ends so far from its target counts as arrived; {most:g} is much"
                )
                yield ConfigIssue(f"robots.{name}.settings.{key}", f"{value:g}", said)


def _ways_back(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    stated = {(way.start, way.end): index for index, way in enumerate(robot.ways)}
    for index, way in enumerate(robot.ways):
        back = stated.get((way.end, way.start))
        said = ""
        if back is None:
            said = (
                f"back from {way.end!r} to {way.start!r} the arm goes straight in the joints; "
                "right if that is free (`cellctl check --moves`)"
            )
        elif back < index and robot.ways[back].via_deg != way.via_deg[::-1]:
            said = (
                f"the way from {way.end!r} to {way.start!r} leads over other joints: a slip in one "
                "of them, or right if both are free (`cellctl check --moves`)"
            )
        if said:
            yield ConfigIssue(f"{path}.{index}", f"{way.start!r} to {way.end!r}", said)


def _joint_bounds(path: str, settings: dict[str, Any]) -> Iterator[ConfigIssue]:
    # Drivers name such settings alike (docs/writing-a-robot-driver.md).
    for key in ("joints_min_deg", "joints_max_deg"):
        bounds_deg = settings.get(key)
        if isinstance(bounds_deg, list) and _largest(bounds_deg) > _MOST_DEG:
            allowed = f"-{_MOST_DEG:g} to {_MOST_DEG:g} for each axis, as taught poses have it"
            yield ConfigIssue(f"{path}.{key}", str(bounds_deg), allowed)


def _boxes(path: str, robot: RobotConfig) -> Iterator[ConfigIssue]:
    long_m = reach_m(robot)
    reach_mm = _LONGEST_REACH_MM if long_m is None else long_m / MM
    for key, value in robot.settings.items():
        corner = key.endswith(("workspace_min_mm", "workspace_max_mm"))
        if corner and isinstance(value, list) and _largest(value) > reach_mm:
            allowed = f"within {reach_mm:.0f} mm of the base, which is as far as the arm reaches"
            yield ConfigIssue(f"{path}.{key}", str(value), allowed)


def _largest(numbers: list[Any]) -> float:
    # What is no number the driver's model has reported.
    return max((abs(one) for one in numbers if isinstance(one, int | float)), default=0.0)
