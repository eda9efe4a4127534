"""An arm of the model: where its links are at given joints, and how fast their bodies can move."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.devices import RobotConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.errors.config import ArmNotDescribed
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.pose import Array
from cellctl.interfaces import Robot


@dataclass(frozen=True, slots=True, eq=False)
class PlannedArm:
    """One robot of the cell, standing in it."""

    name: str
    config: RobotConfig
    chain: ArmChain
    cell_T_base: RigidTransform
    rated_rad_s: Array
    """Shape (6,), at 100 %."""
    driver: type[Robot]
    settings: Any
    """The settings of the driver as an instance of its ``Config``."""
    joint_margin_rad: float
    """What a planned pose keeps from the limits of every joint."""

    def link_frames(self, joints_rad: Array) -> Array:
        """``cell_T_link`` of base and all six links, shape (7, 4, 4), at joints of shape (6,)."""
        return self.cell_T_base.as_matrix() @ self.chain.link_frames(joints_rad)

    def base_T_flange(self, joints_rad: Array) -> RigidTransform:
        """Pose of the flange by the D-H table, at joints of shape (6,)."""
        return self.chain.base_T_flange(joints_rad)

    def refusal(self, joints_rad: Array) -> str | None:
        """Why the robot's driver would not let it stand there; None when it would."""
        try:
            self.driver.check_joint_target(self.settings, joints_rad)
        except TargetOutOfBounds as fault:
            return fault.detail
        return None

    def taught_rad(self, pose: str) -> Array:
        """Joints of a taught pose, shape (6,)."""
        return np.radians(self.config.poses_deg[pose])

    def lever_m(self, link: int, radius_m: float) -> Array:
        """How far a body may be from the axis of each joint, shape (6,), whatever the joints.

        ``radius_m``: of the ball about the origin of the frame of ``link`` that holds the body. A
        joint beyond that link does not move it.
        """
        d_m, a_m = np.abs(self.chain.dh[:, 1]), np.abs(self.chain.dh[:, 2])
        lever = np.zeros(6)
        for joint in range(link):
            # What lies along the joint's own axis does not count for its own turn.
            beyond = np.hypot(d_m, a_m)[joint + 1 : link].sum()
            lever[joint] = a_m[joint] + beyond + radius_m
        return lever


def planned_arm(
    name: str,
    config: RobotConfig,
    cell_T_base: RigidTransform,
    rated_rad_s: Array,
    joint_margin_rad: float,
) -> PlannedArm:
    """The arm as its driver's settings state it; raises ``ArmNotDescribed``."""
    driver, settings = robot_driver(config)
    chain = driver.chain(settings)
    if chain is None:
        raise ArmNotDescribed(f"robots.{name}: its settings have no dh table")
    return PlannedArm(
        name, config, chain, cell_T_base, rated_rad_s, driver, settings, joint_margin_rad
    )
