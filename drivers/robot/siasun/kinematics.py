"""Forward kinematics of an arm by its standard (distal) Denavit-Hartenberg table.

Each joint is Rz(theta) Tz(d) Tx(a) Rx(alpha), with theta the joint's angle and a fixed offset
(Denavit and Hartenberg, J. Appl. Mech. 22 (1955) 215; Siciliano et al., Robotics, section 2.8.2).
"""

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.arm_chain import ArmChain
from drivers.robot.siasun.config import MotionLimits

Row = tuple[float, float, float, float]
"""Offset of the angle (deg), d (mm), a (mm), alpha (deg)."""


class Kinematics:
    """The chain of one arm, from its base to its flange."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self._fixed = [_fixed(d_mm, a_mm, alpha_deg) for _, d_mm, a_mm, alpha_deg in rows]
        self._offsets_rad = np.radians([row[0] for row in rows])

    def base_T_flange(self, joints_rad: Array) -> RigidTransform:
        """Pose of the flange at joints of shape (6,)."""
        pose = np.eye(4)
        for angle_rad, fixed in zip(joints_rad + self._offsets_rad, self._fixed, strict=True):
            pose = pose @ _turn(float(angle_rad)) @ fixed
        return RigidTransform.from_matrix(pose)


def arm_chain(config: MotionLimits) -> ArmChain | None:
    """The chain in SI units with the limits of its joints; None without a dh table."""
    if config.dh is None:
        return None
    scale = np.array([np.radians(1.0), MM, MM, np.radians(1.0)])
    return ArmChain(
        np.array(config.dh) * scale,
        np.radians(config.joints_min_deg),
        np.radians(config.joints_max_deg),
    )


def _turn(angle_rad: float) -> Array:
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    matrix = np.eye(4)
    matrix[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return matrix


def _fixed(d_mm: float, a_mm: float, alpha_deg: float) -> Array:
    alpha_rad = math.radians(alpha_deg)
    cosine, sine = math.cos(alpha_rad), math.sin(alpha_rad)
    matrix = np.eye(4)
    matrix[1:3, 1:3] = [[cosine, -sine], [sine, cosine]]
    matrix[0, 3], matrix[2, 3] = a_mm * MM, d_mm * MM
    return matrix
