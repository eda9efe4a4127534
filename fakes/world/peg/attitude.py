"""Pose of a peg, and the direction of its axis."""

import math

Vector3 = tuple[float, float, float]
Pose6 = tuple[float, float, float, float, float, float]
"""Tip x, y, z (m) in the frame of the hole, tilt about x and y (a rotation vector, rad), and the
turn about the peg's own axis (rad)."""


def axis_of(tilt_x_rad: float, tilt_y_rad: float) -> Vector3:
    """Unit vector from the tip along the peg, in the frame of the hole."""
    angle_rad = math.hypot(tilt_x_rad, tilt_y_rad)
    if angle_rad < 1e-12:
        return 0.0, 0.0, 1.0
    lean = math.sin(angle_rad) / angle_rad
    return lean * tilt_y_rad, -lean * tilt_x_rad, math.cos(angle_rad)
