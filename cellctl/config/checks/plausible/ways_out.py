"""Arms that would leave a zone to the wrong side."""

from collections.abc import Iterator, Set

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.zones import ZoneShare
from cellctl.geometry.pose import MM

_SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")


def way_out_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """A ``way_out`` behind which no taught pose lies, while one lies behind the face opposite.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for zone, config in cell.zones.items():
        for name, share in config.robots.items():
            robot = cell.robots.get(name)
            if robot is None or share.way_out is None or f"robots.{name}" in bad:
                continue
            behind = _behind(robot, share)
            opposite = ("+" if share.way_out[0] == "-" else "-") + share.way_out[1]
            if not behind[share.way_out] and (poses := behind[opposite]):
                allowed = (
                    f"'{opposite}', where its taught pose {poses[0]} lies outside the box; behind "
                    f"'{share.way_out}' lies none. Or the box is on the wrong side"
                )
                yield ConfigIssue(f"zones.{zone}.robots.{name}.way_out", share.way_out, allowed)


def _behind(robot: RobotConfig, share: ZoneShare) -> dict[str, list[str]]:
    """Taught poses whose flange lies behind each face of the box; none without kinematics."""
    found: dict[str, list[str]] = {side: [] for side in _SIDES}
    driver, settings = robot_driver(robot)
    kinematics = driver.forward_kinematics(settings)
    if kinematics is None:
        return found
    for pose, joints_deg in robot.poses_deg.items():
        place_mm = kinematics(np.radians(joints_deg)).translation / MM
        for axis, letter in enumerate("xyz"):
            if place_mm[axis] < share.min_mm[axis]:
                found[f"-{letter}"].append(pose)
            elif place_mm[axis] > share.max_mm[axis]:
                found[f"+{letter}"].append(pose)
    return found
