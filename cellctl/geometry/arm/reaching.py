"""Joints at which the flange has a pose, near given joints."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.geometry.arm.chain import ArmChain, flange_jacobian
from cellctl.geometry.pose import Array

_ROUNDS = 60
"""Half a turn of a joint takes eleven of the longest steps, and near the target each step squares
what is left of the error: what has not been reached by then is out of reach."""
_CLOSE = 1e-9
"""Distance from the target, in m and rad, at which it counts as reached."""
_DAMPED = 1e-4**2 * np.eye(6)
"""Keeps steps finite at a singular pose. Elsewhere the singular values of the Jacobian are hundreds
of times as large, and it is not felt."""
_GREATEST_STEP_RAD = 0.3
"""A longer step leaves the range in which the Jacobian holds, and may lead to another fold."""


def joints_reaching(chain: ArmChain, base_T_flange: Array, near_rad: Array) -> Array | None:
    """Joints of shape (6,) at which the flange has a pose; None when none are found.

    The pose is a matrix of shape (4, 4), because this runs on the event loop, where making a
    transform would take longer than a step. The arm is folded as at ``near_rad``, shape (6,). Joint
    limits are not looked at. Damped Newton steps (Nakamura and Hanafusa, J. Dyn. Syst. Meas.
    Control 108, 1986).
    """
    joints_rad = np.array(near_rad, dtype=float)
    for _ in range(_ROUNDS):
        frames = chain.link_frames(joints_rad)
        error = _error(frames[6], base_T_flange)
        if np.abs(error).max() < _CLOSE:
            return joints_rad
        slope = flange_jacobian(frames)
        square = slope.T @ slope + _DAMPED
        step = np.linalg.solve(square, slope.T @ error)
        joints_rad += step * min(1.0, _GREATEST_STEP_RAD / max(np.abs(step).max(), 1e-12))
    return None


def _error(here: Array, target: Array) -> Array:
    """From here to the target in the axes of the base, shape (6,), in m and rad; both (4, 4)."""
    turn = target[:3, :3] @ here[:3, :3].T
    return np.concatenate([target[:3, 3] - here[:3, 3], _rotation_vector(turn)])


def _rotation_vector(turn: Array) -> Array:
    """Rotation vector of a rotation matrix, shape (3, 3).

    It is taken from the skew part, which is faster than the general way. Near half a turn it says
    nothing.
    """
    twice_sine = np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )
    sine, cosine = float(np.linalg.norm(twice_sine)) / 2.0, (float(np.trace(turn)) - 1.0) / 2.0
    if cosine < 0.0:
        return Rotation.from_matrix(turn).as_rotvec()
    return (
        twice_sine / 2.0 if sine < 1e-12 else twice_sine / 2.0 * (math.asin(min(sine, 1.0)) / sine)
    )
