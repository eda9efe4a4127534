"""Checks every target against the site's bounds before anything is sent."""

import math

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import TargetOutOfBounds
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.interfaces.robot import RobotState
from drivers.robot.siasun.config import SiasunConfig

STEP_MAX_ANGLE_DEG = 0.5
"""The controller refuses a STEP that turns further (protocol, section 4)."""


class Bounds:
    """The bounds of one robot. Methods return the target in the controller's units."""

    def __init__(self, name: str, config: SiasunConfig) -> None:
        self._name = name
        self._config = config

    def joints(self, joints_rad: Array, speed_ratio: float) -> tuple[Array, int]:
        """Joint angles in degrees and speed in percent."""
        joints_deg = np.degrees(np.asarray(joints_rad, dtype=float))
        lower, upper = self._config.joints_min_deg, self._config.joints_max_deg
        inside = joints_deg.shape == (6,) and bool(
            np.all((joints_deg >= lower) & (joints_deg <= upper))
        )
        if not inside:
            self._refuse(f"joints {np.round(joints_deg, 3).tolist()} deg")
        limit = self._config.max_joint_speed_percent
        if not 0.0 < speed_ratio * 100.0 <= limit:
            self._refuse(f"joint speed {speed_ratio * 100.0:g} %, allowed (0, {limit}]")
        return joints_deg, max(1, math.floor(speed_ratio * 100.0 + 1e-9))

    def pose(self, base_T_flange: RigidTransform) -> Array:
        """The pose in its written form, mm and degrees."""
        xyzabc = pose_to_xyzabc(base_T_flange)
        lower, upper = self._config.workspace_min_mm, self._config.workspace_max_mm
        inside = bool(np.all((xyzabc[:3] >= lower) & (xyzabc[:3] <= upper)))
        if not (inside and np.isfinite(xyzabc).all()):
            self._refuse(f"flange at {np.round(xyzabc, 3).tolist()} mm/deg leaves the workspace")
        return xyzabc

    def speed_mm_s(self, speed_m_s: float) -> float:
        """Path speed in mm/s."""
        return self._limited("speed", speed_m_s / MM, self._config.max_speed_mm_s, "mm/s")

    def acceleration_mm_s2(self, acceleration_m_s2: float) -> float:
        """Path acceleration in mm/s²."""
        limit = self._config.max_acceleration_mm_s2
        return self._limited("acceleration", acceleration_m_s2 / MM, limit, "mm/s2")

    def step(self, state: RobotState, base_T_flange: RigidTransform, step_max_mm: float) -> None:
        """A step's length and angle from where the robot is; ``step_max_mm`` is the job's."""
        distance_m, angle_rad = state.distance_to(base_T_flange)
        limit_mm = min(self._config.max_step_mm, step_max_mm)
        if not distance_m / MM <= limit_mm:
            self._refuse(f"step of {distance_m / MM:.4f} mm, allowed {limit_mm:g}")
        if not math.degrees(angle_rad) <= STEP_MAX_ANGLE_DEG:
            self._refuse(f"step turns {math.degrees(angle_rad):.3f} deg")

    def _limited(self, what: str, value: float, limit: float, unit: str) -> float:
        if not 1e-4 <= value <= limit:
            self._refuse(f"{what} {value:g} {unit}, allowed (0, {limit:g}]")
        return value

    def _refuse(self, facts: str) -> None:
        raise TargetOutOfBounds(f"{self._name}: {facts}")
