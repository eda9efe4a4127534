"""Checks that a robot has not moved: what was measured holds only for the place where it stood."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import HeadMoved
from cellctl.geometry.pose import MM
from cellctl.interfaces import Robot

MOVED_M = 0.05 * MM
MOVED_RAD = np.radians(0.005)
"""A robot whose encoders changed by more has moved since the reference was taken.

These are the thresholds within which a deck counts as corrected by default: an arm that has moved
by less has not made a measurement wrong that would be accepted. The encoders of an arm that stands
differ from report to report by a few micrometres, so rest is never taken for a move."""


def require_unmoved(name: str, robot: Robot, base_T_flange: RigidTransform) -> None:
    """Raise ``HeadMoved`` when the robot ``name`` no longer stands at ``base_T_flange``."""
    distance_m, angle_rad = robot.state().distance_to(base_T_flange)
    # Written so that a pose that is not a number counts as moved.
    if not (distance_m <= MOVED_M and angle_rad <= MOVED_RAD):
        raise HeadMoved(f"{name} by {distance_m / MM:.3f} mm, {np.degrees(angle_rad):.4f}°")
