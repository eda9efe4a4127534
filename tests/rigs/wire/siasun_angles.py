"""Rotations of the angles in a record, another way than the driver makes them."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

EULERS = ("ZYX", "XYZ", "ROTVEC")


def rotation_by_hand(euler: str, abc_deg: Sequence[float]) -> Rotation:
    """Rotation from a, b and c in degrees, which stand for z, y and x."""
    a, b, c = abc_deg
    if euler == "ROTVEC":
        return Rotation.from_rotvec(np.radians([c, b, a]))
    about = {"Z": ("z", a), "Y": ("y", b), "X": ("x", c)}
    turns = [Rotation.from_euler(*about[axis], degrees=True) for axis in euler]
    return turns[0] * turns[1] * turns[2]
