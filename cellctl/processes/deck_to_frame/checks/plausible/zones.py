"""Holds the boxes of zones against the places to which this process brings its arms."""

from collections.abc import Collection, Iterator
from itertools import combinations

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.issue import ConfigIssue
from cellctl.config.zones import ZoneConfig
from cellctl.geometry.box import Box
from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, MAIN
from cellctl.processes.deck_to_frame.settings import DeckSettings

_POINTS = 21
"""On each way; the arm goes no farther than a fifth of a metre between two of them."""


def zone_use_issues(
    cell: CellConfig, recipe: DeckRecipe, settings: DeckSettings
) -> Iterator[ConfigIssue]:
    """Boxes into which their arm never comes, and orders of leaving that no Reset goes by."""
    main = recipe.device(MAIN)
    heads = {cell.stereo_cameras[recipe.device(role)].carried_by for role in (HEAD_1, HEAD_2)}
    for zone, config in cell.zones.items():
        yield from _leaving_issues(zone, config, main, heads)
        for name, share in config.robots.items():
            if name not in heads | {main} or name not in cell.robots:
                continue
            places_mm = _places_mm(cell, name, settings if name == main else None)
            if len(places_mm) == 0:
                continue
            box = Box.from_mm(share.min_mm, share.max_mm)
            if not any(box.holds(place_mm * MM) for place_mm in places_mm):
                low, high = places_mm.min(axis=0), places_mm.max(axis=0)
                reached = ", ".join(
                    f"{axis} {a:.0f} to {b:.0f}"
                    for axis, a, b in zip("xyz", low, high, strict=True)
                )
                allowed = (
                    f"a box into which {name} comes: between its taught poses and in procedures "
                    f"its flange is at {reached} mm of its own base"
                )
                value = f"{list(share.min_mm)} to {list(share.max_mm)}"
                yield ConfigIssue(f"zones.{zone}.robots.{name}", value, allowed)


def _leaving_issues(
    zone: str, config: ZoneConfig, main: str, heads: Collection[str | None]
) -> Iterator[ConfigIssue]:
    """Heads that leave before the main robot, which Reset and every procedure bring home first."""
    order = config.retreat
    first = order.index(main) if main in order else len(order)
    early = [name for name in order[:first] if name in heads]
    if main in config.robots and early:
        allowed = (
            f"{main} before {', '.join(early)}: Reset and the procedures bring {main} home before "
            "they move a head, so it would wait here for a head that stays (F314)"
        )
        yield ConfigIssue(f"zones.{zone}.retreat", str(list(order)), allowed)


def _places_mm(cell: CellConfig, name: str, settings: DeckSettings | None) -> Array:
    """Places of the flange on the ways that are known, shape (n, 3); empty without kinematics."""
    robot = cell.robots[name]
    driver, driver_settings = robot_driver(robot)
    kinematics = driver.forward_kinematics(driver_settings)
    if kinematics is None:
        return np.empty((0, 3))
    taught = [np.array(joints_deg) for joints_deg in robot.poses_deg.values()]
    share = np.linspace(0.0, 1.0, _POINTS)[:, None]
    ways = [start + share * (end - start) for start, end in combinations(taught, 2)] + [
        np.array(way.via_deg) for way in robot.ways
    ]
    if settings is not None:
        # Procedure 103 turns A1 and A2 by half of the arc to either side.
        middle, turn = np.array(settings.base_frame_joints_deg), settings.circle_arc_deg
        ways += [middle + (share - 0.5) * turn * np.eye(6)[axis] for axis in (0, 1)]
    joints_deg = np.vstack([*taught, *ways])
    return np.array([kinematics(np.radians(one)).translation for one in joints_deg]) / MM
