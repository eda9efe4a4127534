"""Holds the pose in which the deck is measured against the frame below it, and the zones."""

from collections.abc import Callable, Iterator

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.zones import taught_in_zone
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import Array
from cellctl.processes.deck_to_frame.checks.reach import above_issues
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HEAD_1, HEAD_2, MAIN, MEASURING


def station_issues(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A frame that is not below the taught deck, and arms that would wait for each other."""
    yield from above_issues(cell, recipe.device(MAIN), recipe, key)
    yield from _shared_zones(cell, recipe)


def _kinematics(robot: RobotConfig) -> Callable[[Array], RigidTransform] | None:
    driver, settings = robot_driver(robot)
    return driver.forward_kinematics(settings)


def _shared_zones(cell: CellConfig, recipe: DeckRecipe) -> Iterator[ConfigIssue]:
    """While a head measures the deck, two arms stand at their poses at once."""
    main = recipe.device(MAIN)
    carriers = {cell.stereo_cameras[recipe.device(head)].carried_by for head in (HEAD_1, HEAD_2)}
    for name, zone in cell.zones.items():
        # Without kinematics nobody knows before the arm stands there whether its box holds a pose.
        inside = {
            robot: taught_in_zone(cell.robots[robot], share)
            for robot, share in zone.robots.items()
            if _kinematics(cell.robots[robot]) is not None
        }
        if DECK_MEASURE not in inside.get(main, []):
            continue
        for carrier, poses in inside.items():
            if carrier in carriers and MEASURING in poses:
                share = zone.robots[main]
                allowed = (
                    f"a box without the taught pose {DECK_MEASURE}: {carrier} is in this zone at "
                    f"its pose {MEASURING}, and both must stand there at once"
                )
                value = f"{list(share.min_mm)} to {list(share.max_mm)}"
                yield ConfigIssue(f"zones.{name}.robots.{main}", value, allowed)
