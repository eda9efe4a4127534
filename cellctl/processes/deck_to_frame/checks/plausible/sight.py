"""Whether a head sees the holes of deck and frame that it is to measure.

Where its camera stands is known twice: by the model of the cell, from the base of its arm, and by
the stored board transfer. Lenses are left out: near the edge they move a hole by less than the
margin.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.processes.deck_to_frame.checks.plausible.drawing import PartDrawing
from cellctl.processes.deck_to_frame.checks.plausible.stored import (
    calibrated_joints_deg,
    same_joints,
    stored_record,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HEAD_1, MAIN, MEASURING

_UNKNOWN_CONE = float(np.tan(np.radians(25.0)))
"""Half of a wide lens, for a head whose cameras are not calibrated yet."""
_BEYOND = 0.05
"""A place counts as out of sight when it lies outside of the picture by this share of the picture's
size."""
_NEAREST_M = 0.1
"""Distance before a camera from which on a point can be in its picture."""


@dataclass(frozen=True, slots=True, eq=False)
class PartInPlace:
    """One of the two parts where a head is to measure it."""

    drawing: PartDrawing
    base_T_part: RigidTransform

    def holes_of(self, role: str) -> tuple[str, ...]:
        """Names of the holes that a head is to see."""
        features = self.drawing.features
        return features.head_1 if role == HEAD_1 else features.head_2


@dataclass(frozen=True, slots=True, eq=False)
class Optics:
    """What fits into the picture of the left camera, as shares of the distance."""

    low: Array
    """Least x/z and y/z, shape (2,)."""
    high: Array

    @classmethod
    def of_head(cls, cell: CellConfig, folder: Path, role: str) -> "Optics":
        """The optics of a head as calibrated; a wide cone where it is not calibrated yet."""
        record = stored_record(cell, folder, role)
        if record is None:
            return cls(np.full(2, -_UNKNOWN_CONE), np.full(2, _UNKNOWN_CONE))
        matrix = np.array(record["left"]["camera_matrix"])
        size_px = np.array(record["image_size"], float)
        focal, centre = matrix[[0, 1], [0, 1]], matrix[:2, 2]
        margin = _BEYOND * size_px
        return cls((-margin - centre) / focal, (size_px + margin - centre) / focal)

    def holds(self, point_m: Array) -> bool:
        """Whether a point of the camera's frame, shape (3,), is in the picture."""
        x, y, z = point_m
        if z < _NEAREST_M:
            return False
        return bool(np.all((self.low * z <= (x, y)) & ((x, y) <= self.high * z)))

    def unseen(
        self, base_T_camera: RigidTransform, part: PartInPlace, names: Sequence[str]
    ) -> list[str]:
        """Holes that lie outside of the picture."""
        found = []
        camera_T_part = base_T_camera.inv() * part.base_T_part
        for name in names:
            if not self.holds(camera_T_part.apply(part.drawing.position_mm(name) * MM)):
                found.append(name)
        return found


def flange_at(cell: CellConfig, robot: str, joints_deg: Any) -> RigidTransform | None:
    """``base_T_flange`` at joints in degrees; None for an arm whose kinematics are not known."""
    driver, settings = robot_driver(cell.robots[robot])
    kinematics = driver.forward_kinematics(settings)
    return None if kinematics is None else kinematics(np.radians(joints_deg))


def parts_under_heads(
    cell: CellConfig, recipe: DeckRecipe, deck: PartDrawing, frame: PartDrawing
) -> tuple[PartInPlace, ...]:
    """The frame in its station and the deck at its taught pose, in the base of the main robot."""
    main = recipe.device(MAIN)
    parts = [PartInPlace(frame, pose_from_xyzabc(recipe.base_T_frame))]
    base_T_flange = flange_at(cell, main, cell.robots[main].poses_deg[DECK_MEASURE])
    if base_T_flange is not None:
        parts.append(PartInPlace(deck, base_T_flange * pose_from_xyzabc(recipe.flange_T_deck)))
    return tuple(parts)


def base_T_carrier(
    recipe: DeckRecipe, bases: Mapping[str, Sequence[float]], carrier: str
) -> RigidTransform | None:
    """Base of an arm in that of the main robot, by the model of the cell."""
    main = recipe.device(MAIN)
    if main not in bases or carrier not in bases:
        return None
    return pose_from_xyzabc(bases[main]).inv() * pose_from_xyzabc(bases[carrier])


def calibrated_camera(
    cell: CellConfig, recipe: DeckRecipe, folder: Path, role: str
) -> RigidTransform | None:
    """``base_T_camera`` by the board transfer, where it was made at the present taught pose."""
    carrier = cell.stereo_cameras[recipe.device(role)].carried_by or ""
    joints = calibrated_joints_deg(cell, folder, role)
    transfer = stored_record(cell, folder, BOARD_TRANSFER_NAME)
    if transfer is None or joints is None:
        return None
    if not same_joints(joints, cell.robots[carrier].poses_deg[MEASURING]):
        return None
    written = transfer["base_T_c1" if role == HEAD_1 else "base_T_c2"]["xyz_abc_mm_deg"]
    return pose_from_xyzabc(written)
