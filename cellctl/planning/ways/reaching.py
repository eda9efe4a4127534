"""Joints at which the flange has a pose, near given joints."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm

_ROUNDS = 60
_CLOSE = 1e-9
"""In m and rad."""
_DAMPING = 1e-4
_GREATEST_STEP_RAD = 0.3


def joints_reaching(
    arm: PlannedArm, base_T_flange: RigidTransform, near_rad: Array
) -> Array | None:
    """Joints of shape (6,) folded as ``near_rad``, shape (6,), are; None when none are found.

    Damped Newton steps (Nakamura and Hanafusa, J. Dyn. Syst. Meas. Control 108, 1986). Joint limits
    are not looked at.
    """
    joints_rad = np.array(near_rad, dtype=float)
    for _ in range(_ROUNDS):
        error = _error(arm.base_T_flange(joints_rad), base_T_flange)
        if np.abs(error).max() < _CLOSE:
            return joints_rad
        slope = _jacobian(arm, joints_rad)
        square = slope.T @ slope + _DAMPING**2 * np.eye(6)
        step = np.linalg.solve(square, slope.T @ error)
        joints_rad += step * min(1.0, _GREATEST_STEP_RAD / max(np.abs(step).max(), 1e-12))
    return None


def _error(here: RigidTransform, target: RigidTransform) -> Array:
    """From here to the target in the axes of the base, shape (6,), in m and rad."""
    turn = (target.rotation * here.rotation.inv()).as_rotvec()
    return np.concatenate([target.translation - here.translation, turn])


def _jacobian(arm: PlannedArm, joints_rad: Array) -> Array:
    """Of the flange by the axes of the joints, in the axes of the base, shape (6, 6)."""
    base = arm.cell_T_base.inv().as_matrix()
    frames = base @ arm.link_frames(joints_rad)
    axes, points = frames[:6, :3, 2], frames[:6, :3, 3]
    lever = frames[6, :3, 3] - points
    return np.vstack([np.cross(axes, lever).T, axes.T])
