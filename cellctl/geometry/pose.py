"""Poses as ``scipy.spatial.transform.RigidTransform`` and their written form.

``a_T_b`` is the pose of frame b in frame a; ``a_T_c = a_T_b * b_T_c``. Code is in metres and
radians. Files, PLC, reports and robot controllers write X, Y, Z in mm and A, B, C in degrees with
R = Rz(A) Ry(B) Rx(C) (intrinsic Z-Y'-X'').
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import RigidTransform, Rotation

Array = NDArray[np.float64]

MM = 1e-3
"""Metres in a millimetre."""


def pose_from_xyzabc(xyz_mm_abc_deg: ArrayLike) -> RigidTransform:
    """Pose from its written form, shape (6,): X, Y, Z in mm, A, B, C in degrees.

    Raises ``ValueError`` for anything but six finite numbers.
    """
    values = np.asarray(xyz_mm_abc_deg, dtype=float)
    if values.shape != (6,) or not np.isfinite(values).all():
        raise ValueError(f"a pose is six finite numbers, got {xyz_mm_abc_deg!r}")
    # What `from_components` gives, which takes three times as long: it makes a pose of each of the
    # two, multiplies them and looks whether the product is one.
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("ZYX", values[3:], degrees=True).as_matrix()
    matrix[:3, 3] = values[:3] * MM
    return RigidTransform(matrix, normalize=False)


def pose_to_xyzabc(pose: RigidTransform) -> Array:
    """Written form of a pose, shape (6,): X, Y, Z in mm, A, B, C in degrees."""
    # At B = ±90° only the sum or difference of A and C is determined. The rotation is still the
    # same, which is all that a written pose promises, so that no warning is needed.
    abc_deg = pose.rotation.as_euler("ZYX", degrees=True, suppress_warnings=True)
    return np.concatenate([pose.translation / MM, abc_deg])


def pose_error(expected: RigidTransform, measured: RigidTransform) -> tuple[Array, Array]:
    """Translation (m) and rotation vector (rad) from ``expected`` to ``measured``.

    Both in the axes of the parent frame of the two poses. For small angles the components are the
    errors about x, y and z and do not depend on an Euler convention.
    """
    translation_m = measured.translation - expected.translation
    rotation_rad = (measured.rotation * expected.rotation.inv()).as_rotvec()
    return translation_m, rotation_rad
