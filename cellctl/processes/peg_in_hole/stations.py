"""The devices of a cell by their roles, and the frames in which a peg is inserted."""

from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.devices import Cell
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.config.cell import CellConfig
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.interfaces.streaming_robot import StreamingRobot
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.roles import FORCE
from cellctl.processes.peg_in_hole.search.face import TouchedFace
from cellctl.processes.peg_in_hole.settings import PegSettings

OVER = Rotation.from_rotvec([np.pi, 0.0, 0.0])
"""Rotation from the frame of a hole, z out of its face, to that of a tip, z into the hole."""


@dataclass(frozen=True, slots=True)
class PegCell:
    """The roles of one recipe, taken by devices of the cell."""

    cell: Cell
    arm: GuardedRobot
    """The robot with force sensor and guard."""
    settings: PegSettings

    @classmethod
    def of(cls, cell: Cell, recipe: PegRecipe) -> "PegCell":
        """Roles as the recipe binds them; the check of the cell file saw to it that all exist."""
        return cls(
            cell,
            cell.guarded_robot(recipe.device(FORCE)),
            cast(PegSettings, cell.config.processes[recipe.process]),
        )

    @property
    def recipes(self) -> tuple[PegRecipe, ...]:
        """The recipes of this arm: a hole is stated in the base of the arm that works at it."""
        return tuple(
            recipe
            for recipe in peg_recipes(self.cell.config)
            if recipe.device(FORCE) == self.arm.sensor_name
        )

    @property
    def robot(self) -> StreamingRobot:
        """The arm; the check of the cell file saw to it that it follows a stream."""
        return cast(StreamingRobot, self.arm.robot)


def peg_recipes(config: CellConfig) -> tuple[PegRecipe, ...]:
    """The recipes of this process."""
    return tuple(recipe for recipe in config.recipes if isinstance(recipe, PegRecipe))


def tip_at_hole(recipe: PegRecipe) -> RigidTransform:
    """base_T_tip with the tip in the middle of the hole's face, as it is believed to be."""
    return pose_from_xyzabc(recipe.base_T_hole.pose) * RigidTransform.from_rotation(OVER)


def believed_frames(recipe: PegRecipe, base_T_flange: RigidTransform) -> ContactFrames:
    """Frame A at the believed place, z into the hole; the attitude is the flange's present one."""
    base_T_task = tip_at_hole(recipe)
    flange_T_tip = pose_from_xyzabc(recipe.flange_T_tip)
    task_T_tip = base_T_task.inv() * base_T_flange * flange_T_tip
    return ContactFrames(base_T_task, flange_T_tip, task_T_tip.rotation)


def on_face(frames: ContactFrames, face: TouchedFace) -> ContactFrames:
    """Frame A moved to the touched face and turned to it; the attitude turns with it."""
    slope_x, slope_y = face.slope.tolist()
    normal = np.array([-slope_x, -slope_y, 1.0])
    axis = np.cross([0.0, 0.0, 1.0], normal)
    length = float(np.linalg.norm(axis))
    turn = Rotation.from_rotvec(axis / length * face.tilt_rad if length > 0 else np.zeros(3))
    moved = RigidTransform.from_components(np.array([0.0, 0.0, face.depth_m]), turn)
    return ContactFrames(frames.base_T_task * moved, frames.flange_T_tip, frames.task_R_nominal)


def weight_of(recipe: PegRecipe) -> GravityCompensation:
    """Of the part and its gripper, by the drawing: the tare takes the rest at one attitude."""
    load = recipe.load
    return GravityCompensation.rigid(load.mass_kg, np.array(load.com_in_sensor_mm) * MM)
