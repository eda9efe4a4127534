"""Poses with covariance as the plain data of files and the store: mm and degrees."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM, Array, pose_from_xyzabc, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose

_ROUNDING = 1e-3
"""Largest element of R Rᵀ − I of a matrix in a file: files are often rounded to three or four
digits. The nearest rotation is taken then."""
_NOT_A_POSE = "a pose is a 4 x 4 matrix in mm or six numbers X, Y, Z, A, B, C"
_LEAST_EIGENVALUE = -0.01
"""Of a covariance whose variances are scaled to 1: with numbers rounded to three digits, as files
often have them, one that is 0 comes out as some thousandths on either side."""
_WRITTEN_UNITS = np.array([MM] * 3 + [np.pi / 180] * 3)


def pose_to_record(pose: UncertainPose) -> dict[str, Any]:
    """Matrix in mm, written form, and covariance (x, y, z, rx, ry, rz) in mm and degrees."""
    matrix_mm = pose.pose.as_matrix()
    matrix_mm[:3, 3] /= MM
    return {
        # The matrix is what is read back. The written form beside it is for people and for
        # controllers; at B = ±90° its angles are not unique.
        "matrix_mm": matrix_mm.tolist(),
        "xyz_abc_mm_deg": pose_to_xyzabc(pose.pose).tolist(),
        "covariance_mm_deg": covariance_to_written(pose.covariance).tolist(),
    }


def pose_from_record(record: Mapping[str, Any]) -> UncertainPose:
    """The inverse of ``pose_to_record``; raises ``ValueError`` or ``KeyError``."""
    pose = matrix_mm_to_pose(record["matrix_mm"])
    covariance = np.asarray(record["covariance_mm_deg"], dtype=float)
    if covariance.shape != (6, 6):
        raise ValueError(f"a pose covariance is 6 x 6, got {covariance.shape}")
    return UncertainPose(pose, covariance_from_written(covariance))


def covariance_to_written(covariance: Array) -> Array:
    """From m, rad to mm, degrees."""
    return covariance / np.outer(_WRITTEN_UNITS, _WRITTEN_UNITS)


def covariance_from_written(covariance: Array) -> Array:
    """From mm, degrees to m, rad; raises ``ValueError`` for what no errors can have."""
    return require_covariance(covariance * np.outer(_WRITTEN_UNITS, _WRITTEN_UNITS))


def require_covariance(covariance: Array) -> Array:
    """The covariance of a pose, shape (6, 6); raises ``ValueError`` for a matrix that is none.

    One with a negative variance in some direction would make a pose more certain by every other
    pose that it is joined to.
    """
    variances = np.diag(covariance)
    if (variances < 0.0).any():
        raise ValueError("a covariance has no negative variances")
    # Lengths and angles differ by orders of magnitude; what has no variance has no unit either.
    scale = np.sqrt(np.where(variances > 0.0, variances, 1.0))
    scaled = covariance / np.outer(scale, scale)
    if np.abs(scaled - scaled.T).max() > -_LEAST_EIGENVALUE:
        raise ValueError("a covariance is symmetric")
    if np.linalg.eigvalsh(scaled).min() < _LEAST_EIGENVALUE:
        raise ValueError("a covariance is positive semidefinite: no direction has less than none")
    return covariance


def matrix_mm_to_pose(values: Any) -> RigidTransform:
    """A 4x4 matrix in mm, or X, Y, Z, A, B, C in mm and degrees; raises ``ValueError``."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(_NOT_A_POSE) from error
    if array.shape == (6,):
        return pose_from_xyzabc(array)
    if array.shape != (4, 4) or not np.isfinite(array).all():
        raise ValueError(_NOT_A_POSE)
    rotation = array[:3, :3]
    if not _is_rotation(rotation):
        raise ValueError("the rotation part of a pose is not a rotation")
    matrix = array.copy()
    matrix[:3, 3] *= MM
    return RigidTransform.from_matrix(matrix)


def _is_rotation(matrix: Array) -> bool:
    """Whether a 3x3 matrix is near a rotation.

    Files from other programs have few decimals, so the tolerance is wide; ``RigidTransform`` makes
    the matrix orthogonal.
    """
    # First of all no element is so large that its square overflows; at last no reflection.
    return bool(
        np.abs(matrix).max() < 1.0 + _ROUNDING
        and np.abs(matrix @ matrix.T - np.eye(3)).max() <= _ROUNDING
        and np.linalg.det(matrix) > 0
    )
