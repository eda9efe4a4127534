"""Conventions of three angles, by name, and the matrix that they make; plain floats, no arrays.

Apart from ``euler`` because the guard reads poses too, and must stay without arrays.
"""

import math
from collections.abc import Callable
from enum import Enum

Rows = tuple[float, float, float, float, float, float, float, float, float]
"""A rotation matrix, row by row."""


class EulerOrder(Enum):
    """How three angles (rx, ry, rz), in rad about x, y and z, make a rotation matrix R."""

    FIXED_XYZ = "fixed-xyz"
    """About the fixed axes x, then y, then z: R = Rz Ry Rx. The same as the moving axes z, y', x''.
    """
    MOVING_XYZ = "moving-xyz"
    """About the moving axes x, then y', then z'': R = Rx Ry Rz."""
    ROTATION_VECTOR = "rotation-vector"
    """Not Euler angles: the axis of the rotation times its angle."""

    def rows(self, rx: float, ry: float, rz: float) -> Rows:
        """R of three finite angles in rad (Siciliano et al., Robotics, sections 2.4 and 2.5)."""
        return _ROWS[self](rx, ry, rz)


def _fixed_xyz(rx: float, ry: float, rz: float) -> Rows:
    cx, cy, cz = math.cos(rx), math.cos(ry), math.cos(rz)
    sx, sy, sz = math.sin(rx), math.sin(ry), math.sin(rz)
    return (
        *(cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx),
        *(sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx),
        *(-sy, cy * sx, cy * cx),
    )


def _moving_xyz(rx: float, ry: float, rz: float) -> Rows:
    # (Rx Ry Rz)(angles) is the transpose of (Rz Ry Rx)(minus the angles).
    xx, xy, xz, yx, yy, yz, zx, zy, zz = _fixed_xyz(-rx, -ry, -rz)
    return xx, yx, zx, xy, yy, zy, xz, yz, zz


def _rotation_vector(rx: float, ry: float, rz: float) -> Rows:
    angle = math.hypot(rx, ry, rz)
    if angle == 0.0:
        return 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    x, y, z = rx / angle, ry / angle, rz / angle
    c, s = math.cos(angle), math.sin(angle)
    d = 2.0 * math.sin(angle / 2.0) ** 2  # 1 - cos, without its loss of digits at small angles
    return (
        *(c + d * x * x, d * x * y - s * z, d * x * z + s * y),
        *(d * x * y + s * z, c + d * y * y, d * y * z - s * x),
        *(d * x * z - s * y, d * y * z + s * x, c + d * z * z),
    )


_ROWS: dict[EulerOrder, Callable[[float, float, float], Rows]] = {
    EulerOrder.FIXED_XYZ: _fixed_xyz,
    EulerOrder.MOVING_XYZ: _moving_xyz,
    EulerOrder.ROTATION_VECTOR: _rotation_vector,
}
