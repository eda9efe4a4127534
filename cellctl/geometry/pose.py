"""Poses as ``scipy.spatial.transform.RigidTransform`` and their written form.

``a_T_b`` is the pose of frame b in frame a; ``a_T_c = a_T_b * b_T_c``. Code is in metres and
radians. Files, PLC, reports and robot controllers write X, Y, Z in mm and A, B, C in degrees with
R = Rz(A) Ry(B) Rx(C) (intrinsic Z-Y'-X'').
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import RigidTransform

Array = NDArray[np.float64]

MM = 1e-3
"""Metres in a millimetre."""
_POLE = 1e-9
"""Cosine of B below which only the sum or difference of A and C is determined."""


def pose_from_xyzabc(xyz_mm_abc_deg: ArrayLike) -> RigidTransform:
    """Pose from its written form, shape (6,): X, Y, Z in mm, A, B, C in degrees.

    Raises ``ValueError`` for anything but six finite numbers.
    """
    values = np.asarray(xyz_mm_abc_deg, dtype=float)
    if values.shape != (6,) or not np.isfinite(values).all():
        raise ValueError(f"a pose is six finite numbers, got {xyz_mm_abc_deg!r}")
    return RigidTransform(_matrix(values.tolist()), normalize=False)


def pose_to_xyzabc(pose: RigidTransform) -> Array:
    """Written form of a pose, shape (6,): X, Y, Z in mm, A, B, C in degrees.

    At B = ±90°, where only the sum or difference of A and C is determined, C is 0.
    """
    rows = pose.as_matrix().tolist()
    (xx, xy, xz, x_m), (yx, yy, yz, y_m), (zx, _, _, z_m), _ = rows
    level = math.hypot(xx, yx)
    a = math.atan2(yx, xx) if level > _POLE else math.atan2(-xy, yy)
    sin, cos = math.sin(a), math.cos(a)
    # C is what is left of the rotation once A is undone: however little A is determined beside a
    # pole, the three together are then the rotation.
    c = math.atan2(sin * xz - cos * yz, cos * yy - sin * xy)
    turn = (math.degrees(angle) for angle in (a, math.atan2(-zx, level), c))
    # A zero without a sign: a file with -0.0 would differ from one with 0.0 for no reason.
    return np.array([x_m / MM, y_m / MM, z_m / MM, *turn]) + 0.0


def turn_matrix(turn_rad: Array) -> Array:
    """Rotation matrix, shape (3, 3), of a rotation vector, shape (3,): the formula of Rodrigues.

    For what every tick of a stream asks: SciPy's rotations do the same and take several times as
    long, because they also take stacks and arrays of other libraries.
    """
    x, y, z = turn_rad.tolist()
    square = x * x + y * y + z * z
    # Near zero both quotients are the series of sine and cosine, of which the next terms are below
    # the last digit.
    if square < 1e-6:
        along, across = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        angle = math.sqrt(square)
        along, across = math.sin(angle) / angle, (1.0 - math.cos(angle)) / square
    xy, xz, yz = across * x * y, across * x * z, across * y * z
    return np.array(
        [
            [1.0 - across * (y * y + z * z), xy - along * z, xz + along * y],
            [xy + along * z, 1.0 - across * (x * x + z * z), yz - along * x],
            [xz - along * y, yz + along * x, 1.0 - across * (x * x + y * y)],
        ]
    )


def pose_error(expected: RigidTransform, measured: RigidTransform) -> tuple[Array, Array]:
    """Translation (m) and rotation vector (rad) from ``expected`` to ``measured``.

    Both in the axes of the parent frame of the two poses. For small angles the components are the
    errors about x, y and z and do not depend on an Euler convention.
    """
    translation_m = measured.translation - expected.translation
    rotation_rad = (measured.rotation * expected.rotation.inv()).as_rotvec()
    return translation_m, rotation_rad


# By their elements: the general functions of scipy give the same and take thirty times as long,
# which a daemon that writes down every report of every robot does not have.
def _matrix(values: list[float]) -> Array:
    """Homogeneous matrix, shape (4, 4), of a written pose."""
    x_m, y_m, z_m = (value * MM for value in values[:3])
    a, b, c = (math.radians(value) for value in values[3:])
    (sa, ca), (sb, cb), (sc, cc) = ((math.sin(angle), math.cos(angle)) for angle in (a, b, c))
    return np.array(
        [
            [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc, x_m],
            [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc, y_m],
            [-sb, cb * sc, cb * cc, z_m],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
