"""Pose of a peg in the frame of its hole, and the direction of its axis."""

import math

from fakes.world.frames import Array

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


def pose_of(hole_T_peg: Array) -> Pose6:
    """Pose from a 4x4 matrix: the peg is turned about its axis, then tilted by less than 90°."""
    (r00, _, sx, x), (r10, _, sy, y), (r20, _, sz, z), _ = hole_T_peg.tolist()
    level = math.hypot(sx, sy)
    stretch = math.atan2(level, sz) / level if level > 1e-12 else 1.0
    # First column of the turn alone: the shortest rotation from the peg's axis to z, applied to r0.
    tilted = r20 / (1.0 + sz)
    first_x, first_y = r00 - sx * tilted, r10 - sy * tilted
    return x, y, z, -sy * stretch, sx * stretch, math.atan2(first_y, first_x)
