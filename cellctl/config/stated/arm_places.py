"""Places at which one arm stands, by the poses and the kinematics of its cell file."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.stated.moves import StatedPlace
from cellctl.errors.config import ArmNotDescribed


@dataclass(frozen=True, slots=True)
class ArmPlaces:
    """The places of one arm."""

    cell: CellConfig
    robot: str
    """Its name in the cell file."""

    def taught(self, pose: str) -> StatedPlace:
        """A taught pose."""
        return StatedPlace(pose, np.radians(self.cell.robots[self.robot].poses_deg[pose]))

    def flange_at(self, place: StatedPlace) -> RigidTransform:
        """``base_T_flange`` at a place; raises ``ArmNotDescribed``."""
        if place.base_T_flange is not None:
            return place.base_T_flange
        driver, settings = robot_driver(self.cell.robots[self.robot])
        kinematics = driver.forward_kinematics(settings)
        if kinematics is None:
            raise ArmNotDescribed(f"robots.{self.robot}: its settings have no dh table")
        return kinematics(place.joints_rad)
