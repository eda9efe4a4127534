"""The ways of the flanges between taught poses, through the points that the cell file states."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cellctl.config.stated.moves import MoveKind
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import Array
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.ways.check_moves import stated_moves
from cellctl.planning.ways.polyline import polyline


@dataclass(frozen=True, slots=True, eq=False)
class FlangePath:
    """One way."""

    name: str
    points_m: Array
    """Points of the path in the frame of the cell, shape (n, 3)."""


def flange_paths(scene: CellScene) -> Iterator[FlangePath]:
    """Of each move by joints between two taught poses that a process can command, once for both
    directions.

    Raises ``PlaceUnreachable``.
    """
    drawn: set[tuple[str, frozenset[str]]] = set()
    for move in stated_moves(scene):
        arm = scene.arms.get(move.robot)
        ends = frozenset((move.start.label, move.end.label))
        if arm is None or move.kind is not MoveKind.JOINT or (move.robot, ends) in drawn:
            continue
        if not ends <= set(arm.config.poses_deg):
            continue
        drawn.add((move.robot, ends))
        way = [joint_path(*both) for both in pairwise(polyline(arm, move))]
        poses = [arm.cell_T_base * arm.base_T_flange(at_rad) for at_rad in np.vstack(way)]
        name = f"{move.robot}: {move.start.label} to {move.end.label}"
        yield FlangePath(name, np.array([pose.translation for pose in poses]))
