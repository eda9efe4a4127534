"""Arms that would leave a zone to the wrong side."""

from collections.abc import Iterator, Set

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.plausible.resting import resting_poses
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.zones import ZoneShare
from cellctl.geometry.pose import MM

_SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")


def way_out_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """A ``way_out`` behind which its arm rests nowhere, while it does behind another face.

    Upwards is a way out of every box over which the arm may come: it goes home over the box.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    resting = resting_poses(cell)
    for zone, config in cell.zones.items():
        for name, share in config.robots.items():
            robot = cell.robots.get(name)
            if robot is None or share.way_out is None or f"robots.{name}" in bad:
                continue
            # Of a robot without a recipe nobody knows at which of its poses it rests.
            behind = _behind(robot, share, resting.get(name) or robot.poses_deg.keys())
            others = {side: poses[0] for side, poses in behind.items() if poses}
            upwards = share.way_out == "+z" and _may_rise_over(robot, share)
            if share.way_out not in others and others and not upwards:
                sides = " or ".join(f"'{side}'" for side in others)
                pose = next(iter(others.values()))
                allowed = (
                    f"{sides}, where its taught pose {pose} lies outside the box, to which it "
                    f"leaves; behind '{share.way_out}' lies none. Or the box is on the wrong side"
                )
                yield ConfigIssue(f"zones.{zone}.robots.{name}.way_out", share.way_out, allowed)


def _may_rise_over(robot: RobotConfig, share: ZoneShare) -> bool:
    """Whether the bounds of straight moves let the flange stand over the box."""
    # Drivers name such settings alike (docs/writing-a-robot-driver.md).
    highest_mm = robot.settings.get("workspace_max_mm")
    return highest_mm is not None and share.max_mm[2] < highest_mm[2]


def _behind(robot: RobotConfig, share: ZoneShare, poses: Set[str]) -> dict[str, list[str]]:
    """Those of the poses whose flange lies behind each face of the box; none without kinematics."""
    found: dict[str, list[str]] = {side: [] for side in _SIDES}
    driver, settings = robot_driver(robot)
    kinematics = driver.forward_kinematics(settings)
    if kinematics is None:
        return found
    for pose in robot.poses_deg:
        if pose not in poses:
            continue
        place_mm = kinematics(np.radians(robot.poses_deg[pose])).translation / MM
        for axis, letter in enumerate("xyz"):
            if place_mm[axis] < share.min_mm[axis]:
                found[f"-{letter}"].append(pose)
            elif place_mm[axis] > share.max_mm[axis]:
                found[f"+{letter}"].append(pose)
    return found
