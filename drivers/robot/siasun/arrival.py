"""Checks that a robot which stands still after a move stands where it was sent."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array
from cellctl.interfaces.robot import RobotState
from drivers.robot.siasun.config import MotionLimits


class Arrival:
    """Methods return how far off the robot is, as text, or None where it has arrived."""

    def __init__(self, config: MotionLimits) -> None:
        self._tolerance_mm = config.arrival_tolerance_mm
        self._tolerance_deg = config.arrival_tolerance_deg

    def off_pose(self, state: RobotState, base_T_flange: RigidTransform) -> str | None:
        """Distance of the reported flange from its target."""
        distance_m, angle_rad = state.distance_to(base_T_flange)
        distance_mm, angle_deg = distance_m / MM, float(np.degrees(angle_rad))
        # Written so that a pose that is not a number has not arrived.
        if distance_mm <= self._tolerance_mm and angle_deg <= self._tolerance_deg:
            return None
        return f"{distance_mm:.3f} mm and {angle_deg:.3f} deg"

    def off_joints(self, state: RobotState, joints_rad: Array) -> str | None:
        """Difference of the reported joint angles from theirs, J1 to J6."""
        off_deg = np.degrees(state.joints_rad - joints_rad)
        if np.all(np.abs(off_deg) <= self._tolerance_deg):
            return None
        return f"{np.round(off_deg, 3).tolist()} deg"
