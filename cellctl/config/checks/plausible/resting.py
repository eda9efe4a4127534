"""Arms that would rest in a space that they share, and hold it for good."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Set

from cellctl.config.cell import CellConfig
from cellctl.config.checks.zones import taught_in_zone
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.config.process_definition import process_definition
from cellctl.config.roles import arm_of


def resting_poses(cell: CellConfig) -> Mapping[str, Set[str]]:
    """Taught poses at which each robot stays while others work, by the processes of its recipes."""
    found: dict[str, set[str]] = defaultdict(set)
    for recipe in cell.recipes:
        for name, role in process_definition(recipe.process).roles.items():
            arm = arm_of(cell, role, recipe.device(name))
            if arm in cell.robots:
                found[arm] |= set(role.rests_at) & cell.robots[arm].poses_deg.keys()
    return found


def resting_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Resting poses within a zone.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    resting = resting_poses(cell)
    for zone, config in cell.zones.items():
        for name, share in config.robots.items():
            if name not in cell.robots or f"robots.{name}" in bad or not _is_known(cell, name):
                continue
            robot = cell.robots[name]
            inside = taught_in_zone(robot, share)
            outside = [pose for pose in robot.poses_deg if pose not in inside]
            others = ", ".join(other for other in config.robots if other != name)
            for pose in sorted(resting.get(name, set()) & set(inside)):
                lie = "lies" if len(outside) == 1 else "lie"
                slip = (
                    f"; outside of it {lie} {', '.join(outside)}: did you exchange them?"
                    if outside
                    else ""
                )
                allowed = (
                    f"a place outside of zones.{zone}: the arm rests at this pose while others "
                    f"work, and would keep {others} out of the zone for good (F314){slip}"
                )
                box = f"{list(share.min_mm)} to {list(share.max_mm)}"
                yield ConfigIssue(
                    f"robots.{name}.poses_deg.{pose}",
                    str(list(robot.poses_deg[pose])),
                    allowed,
                    against=(WrittenValue(f"zones.{zone}.robots.{name}", box),),
                )


def _is_known(cell: CellConfig, name: str) -> bool:
    """Whether the driver's settings say where the flange is at a taught pose."""
    driver, settings = robot_driver(cell.robots[name])
    return driver.forward_kinematics(settings) is not None
