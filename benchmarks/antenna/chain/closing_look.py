"""The last look at the stand-off: housing and panel marks in one image, closed by small steps.

The cameras carry the connector over to outer marks in their own images beforehand, so neither the
robot's repeatability nor its kinematics enters. What a small step adds, and what the looks measure,
are assumed figures, not measured ones.
"""

import numpy as np

from cellctl.geometry.pose import Array

TRANSFER_M = 1.0e-6
"""Plug to housing edges, and socket to panel marks: standard deviation of each, per axis."""
LOOK_M = 1.5e-6
STEP_M = 3.5e-6
"""Standard deviation of one small step of the robot, per axis."""
TAUGHT_M = 2.5e-6
"""What stays of the constant part after teaching, once per cell."""
YAW_LOOK_RAD = float(np.radians(0.005))
CLOSED_M = 6e-6
MAX_STEPS = 3


def draw_taught_offset(rng: np.random.Generator) -> Array:
    """The constant error of a cell's closing looks: x, y (m), yaw (rad)."""
    return np.array([*rng.normal(0, TAUGHT_M, 2), rng.normal(0, YAW_LOOK_RAD)])


def close_by_steps(error: Array, taught_offset: Array, rng: np.random.Generator) -> Array:
    """The plug's error once the look shows it closed, or after the last step allowed."""
    transfer_m = TRANSFER_M * np.sqrt(2)
    constant = taught_offset + np.append(rng.normal(0, transfer_m, 2), 0.0)
    for _ in range(MAX_STEPS):
        seen = error + constant + [*rng.normal(0, LOOK_M, 2), rng.normal(0, YAW_LOOK_RAD)]
        if np.linalg.norm(seen[:2]) <= CLOSED_M:
            break
        error = error - seen + [*rng.normal(0, STEP_M, 2), 0.0]
    return error
