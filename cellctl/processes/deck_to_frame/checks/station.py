"""Holds the pose in which the deck is measured against the frame below it, and the zones."""

from collections.abc import Callable, Iterator

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.checks.zones import taught_in_zone
from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HEAD_1, HEAD_2, MAIN, MEASURING

_BESIDE_MM = 200.0
_TURNED_DEG = 20.0
"""The heads measure deck and frame from one place: what is farther off, or turned more, has its
holes outside of a field of view of 0.3 m."""


def station_issues(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    """A frame that is not below the taught deck, and arms that would wait for each other."""
    yield from _above_the_frame(cell, recipe, key)
    yield from _shared_zones(cell, recipe)


def _above_the_frame(cell: CellConfig, recipe: DeckRecipe, key: str) -> Iterator[ConfigIssue]:
    robot = cell.robots[recipe.device(MAIN)]
    kinematics = _kinematics(robot)
    if kinematics is None:
        return
    base_T_deck = kinematics(np.radians(robot.poses_deg[DECK_MEASURE])) * pose_from_xyzabc(
        recipe.flange_T_deck
    )
    frame_T_deck = pose_from_xyzabc(recipe.base_T_frame).inv() * base_T_deck
    x_mm, y_mm, z_mm = frame_T_deck.translation / MM
    turned_deg = np.degrees(frame_T_deck.rotation.magnitude())
    if np.hypot(x_mm, y_mm) > _BESIDE_MM or turned_deg > _TURNED_DEG:
        allowed = (
            f"below the deck at the taught pose {DECK_MEASURE}, within {_BESIDE_MM:g} mm and "
            f"{_TURNED_DEG:g} deg; the deck is at x {x_mm:.0f}, y {y_mm:.0f} mm of the frame, "
            f"turned by {turned_deg:.0f} deg"
        )
        yield ConfigIssue(f"{key}.base_T_frame", str(list(recipe.base_T_frame)), allowed)
    elif z_mm < recipe.deck_thickness_mm + recipe.stand_off_mm:
        allowed = (
            f"at most {z_mm - recipe.stand_off_mm:.0f}: at the taught pose {DECK_MEASURE} the "
            f"outer face of the deck is {z_mm:.0f} mm above the frame, and the stand-off stays free"
        )
        thickness = f"{recipe.deck_thickness_mm:g}"
        yield ConfigIssue(f"{key}.deck_thickness_mm", thickness, allowed)


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
