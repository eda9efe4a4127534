"""How a six-axis arm is folded, from its joints."""

import numpy as np

from cellctl.geometry.pose import Array

WRIST_JOINTS = (2, 4)
"""Elbow (A3) and wrist (A5). Their signs tell the ways apart in which an arm reaches one pose."""
_STRAIGHT_RAD = float(np.radians(1.0))
"""Nearer to straight, the sign of a joint does not tell to which side the arm will fold."""


def wrist_configuration(joints_rad: Array) -> tuple[int, ...]:
    """Signs of A3 and A5; 0 within 1° of straight, where the arm may fold over."""
    return tuple(
        0 if abs(joints_rad[joint]) < _STRAIGHT_RAD else int(np.sign(joints_rad[joint]))
        for joint in WRIST_JOINTS
    )
