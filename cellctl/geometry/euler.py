"""Orientations as three angles, in the conventions that robot controllers use.

Nearly every controller writes an orientation as three numbers, and nearly none says in the numbers
which convention they follow. Each convention has a name here, so that a cell file can state it and
nothing is guessed.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from cellctl.geometry.euler_order import EulerOrder
from cellctl.geometry.pose import Array

_POLE = 1e-9
"""Cosine of the middle angle below which only the sum or difference of the others is defined."""


def rotation_of(order: EulerOrder, angles_rad: ArrayLike) -> Rotation:
    """Rotation of three angles, shape (3,), in the order rx, ry, rz; ``ValueError`` if they are
    none."""
    angles = np.asarray(angles_rad, dtype=float)
    if angles.shape != (3,) or not np.isfinite(angles).all():
        raise ValueError(f"an orientation is three finite numbers, got {angles_rad!r}")
    return Rotation.from_matrix(np.reshape(order.rows(*angles.tolist()), (3, 3)))


def angles_of(order: EulerOrder, rotation: Rotation) -> Array:
    """Angles, shape (3,), in the order rx, ry, rz, each in [-pi, pi].

    At the poles, where ry is ±pi/2, rx is set to 0: only the sum or difference of rx and rz is
    defined there, and the rotation is the same for every choice.
    """
    if order is EulerOrder.ROTATION_VECTOR:
        return np.asarray(rotation.as_rotvec())
    matrix = rotation.as_matrix()
    return _fixed_xyz(matrix) if order is EulerOrder.FIXED_XYZ else _moving_xyz(matrix)


# The last angle is taken from what is left of the rotation once the first is undone. However little
# the first is determined beside a pole, the three together are then the rotation.


def _fixed_xyz(matrix: Array) -> Array:
    """(rx, ry, rz) of R = Rz Ry Rx (angles: Siciliano et al., Robotics, section 2.4.2)."""
    level = math.hypot(matrix[0, 0], matrix[1, 0])
    rx = math.atan2(matrix[2, 1], matrix[2, 2]) if level > _POLE else 0.0
    across = math.cos(rx) * matrix[:, 1] - math.sin(rx) * matrix[:, 2]
    return np.array([rx, math.atan2(-matrix[2, 0], level), math.atan2(-across[0], across[1])])


def _moving_xyz(matrix: Array) -> Array:
    """(rx, ry, rz) of R = Rx Ry Rz."""
    level = math.hypot(matrix[0, 0], matrix[0, 1])
    rx = math.atan2(-matrix[1, 2], matrix[2, 2]) if level > _POLE else 0.0
    across = math.cos(rx) * matrix[1] + math.sin(rx) * matrix[2]
    return np.array([rx, math.atan2(matrix[0, 2], level), math.atan2(across[0], across[1])])
