"""Where the flange of each arm has to come, by its taught poses and the moves of the processes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.tables import described_arms
from cellctl.config.devices import RobotConfig
from cellctl.config.process_definition import process_definition
from cellctl.config.stated.moves import MoveKind, StatedPlace
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.pose import MM, Array

BOXES = ("workspace", "joint_workspace")
"""First parts of the names that drivers give to the corners of their boxes
(docs/writing-a-robot-driver.md); the second one is that of joint moves."""


@dataclass(frozen=True, slots=True, eq=False)
class ArmNeeds:
    """What one arm has to reach, in its base."""

    name: str
    chain: ArmChain
    straight_mm: Array
    """Places of the flange at the ends of straight moves, shape (n, 3)."""
    joint_mm: Array
    """The same at taught poses and at the ends of joint moves."""
    joints_deg: Array
    """Joints wherever they decide, shape (n, 6)."""


@dataclass(frozen=True, slots=True, eq=False)
class BoxRoom:
    """A box of the flange, and what it leaves beyond all that has to lie in it."""

    key: str
    """Path of its corners without ``_min_mm`` and ``_max_mm``."""
    lower_mm: Array
    upper_mm: Array
    below_mm: Array
    """From each lower face to the nearest place, shape (3,); negative where one lies outside."""
    above_mm: Array


def arm_needs(cell: CellConfig, folder: Path) -> Iterator[ArmNeeds]:
    """The needs of every arm of a good cell file in ``folder``.

    None where an arm of it is not described: processes state their moves of all arms together.
    """
    chains = described_arms(cell, frozenset())
    if len(chains) < len(cell.robots):
        return
    moves = [
        move
        for recipe in cell.recipes
        for move in process_definition(recipe.process).moves(cell, recipe, folder)
    ]
    for name, chain in chains.items():
        taught = [np.radians(joints_deg) for joints_deg in cell.robots[name].poses_deg.values()]
        ends = {
            kind: [
                place
                for move in moves
                if move.robot == name and move.kind is kind
                for place in (move.start, move.end)
            ]
            for kind in MoveKind
        }
        deciding = [
            place.joints_rad
            for places in ends.values()
            for place in places
            if place.base_T_flange is None
        ]
        at_poses = [StatedPlace("", joints_rad) for joints_rad in taught]
        yield ArmNeeds(
            name,
            chain,
            _places_mm(chain, ends[MoveKind.LINEAR]),
            _places_mm(chain, [*at_poses, *ends[MoveKind.JOINT]]),
            np.degrees(np.reshape([*taught, *deciding], (-1, 6))),
        )


def rooms(robot: RobotConfig, needs: ArmNeeds) -> Iterator[BoxRoom]:
    """The room in each box that the settings of an arm state."""
    joint_box = f"{BOXES[1]}_min_mm" in robot.settings or f"{BOXES[1]}_max_mm" in robot.settings
    both = np.concatenate([needs.straight_mm, needs.joint_mm])
    inside = {BOXES[0]: needs.straight_mm if joint_box else both}
    if joint_box:
        inside[BOXES[1]] = needs.joint_mm
    for box, places_mm in inside.items():
        lower, upper = (
            robot.settings.get(f"{box}_{end}_mm", robot.settings.get(f"{BOXES[0]}_{end}_mm"))
            for end in ("min", "max")
        )
        if lower is not None and upper is not None and len(places_mm):
            lower_mm, upper_mm = np.array(lower, float), np.array(upper, float)
            yield BoxRoom(
                f"robots.{needs.name}.settings.{box}",
                lower_mm,
                upper_mm,
                places_mm.min(axis=0) - lower_mm,
                upper_mm - places_mm.max(axis=0),
            )


def _places_mm(chain: ArmChain, places: Sequence[StatedPlace]) -> Array:
    found = [
        chain.link_frames(place.joints_rad)[6, :3, 3]
        if place.base_T_flange is None
        else place.base_T_flange.translation
        for place in places
    ]
    return np.reshape(found, (-1, 3)) / MM
