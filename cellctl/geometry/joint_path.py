"""The way of a joint move: all joints begin and arrive together, straight in joint space."""

import math

import numpy as np

from cellctl.geometry.pose import Array

STEP_RAD = math.radians(1.0)
"""A flange 3 m from the axis moves by 52 mm between two points."""


def joint_path(start_rad: Array, target_rad: Array) -> Array:
    """Joints on the way, shape (n, 6), both ends included; no joint turns further than a step.

    Both ends have shape (6,) and are finite.
    """
    # The joint with the longest way sets the number of points, because all joints arrive together.
    greatest_rad = float(np.abs(target_rad - start_rad).max())
    points = max(2, math.ceil(greatest_rad / STEP_RAD) + 1)
    return np.linspace(start_rad, target_rad, points)
