"""The devices of an antenna cell by their roles, so that steps read like the process."""

from dataclasses import dataclass
from typing import cast

from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.config.cell import CellConfig
from cellctl.errors.config import ConfigInvalid
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces import Camera, Gripper
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import CAMERA_1, CAMERA_2, FORCE, GRIPPER
from cellctl.processes.antenna_module.settings import AntennaSettings
from cellctl.workers import VisionWorkers


@dataclass(frozen=True, slots=True)
class AntennaCell:
    """The roles of one recipe, taken by devices of the cell."""

    cell: Cell
    arm: GuardedRobot
    """The robot with force sensor and guard."""
    camera_1: Camera
    camera_2: Camera
    gripper: Gripper
    settings: AntennaSettings
    flange_T_camera_1: RigidTransform
    """Pose of camera I by the cell file, for planning views only; what was measured, procedure 203
    stores."""

    @classmethod
    def of(cls, cell: Cell, recipe: AntennaRecipe) -> "AntennaCell":
        """Roles as the recipe binds them; the check of the cell file saw to it that all exist."""
        camera_1 = recipe.device(CAMERA_1)
        on_flange = cell.config.cameras[camera_1].flange_T_camera
        if on_flange is None:
            raise ConfigInvalid(f"cameras.{camera_1}.flange_T_camera is missing")
        return cls(
            cell,
            cell.guarded_robot(recipe.device(FORCE)),
            cell.cameras[camera_1],
            cell.cameras[recipe.device(CAMERA_2)],
            cell.grippers[recipe.device(GRIPPER)],
            cast(AntennaSettings, cell.config.processes[recipe.process]),
            pose_from_xyzabc(on_flange),
        )

    @property
    def recipes(self) -> tuple[AntennaRecipe, ...]:
        """The recipes of this arm: tray and socket are stated in the base of the arm that works
        there."""
        return tuple(
            recipe
            for recipe in antenna_recipes(self.cell.config)
            if recipe.device(FORCE) == self.arm.sensor_name
        )

    @property
    def workers(self) -> VisionWorkers:
        """The vision workers, for images and long solves."""
        return self.cell.workers


def antenna_recipes(config: CellConfig) -> tuple[AntennaRecipe, ...]:
    """The recipes of this process."""
    return tuple(recipe for recipe in config.recipes if isinstance(recipe, AntennaRecipe))
