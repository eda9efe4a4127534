"""Poses of the world: the written form, small displacements, seeded random streams."""

from collections.abc import Sequence
from math import asin, atan2, cos, degrees, hypot, radians, sin, sqrt
from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import RigidTransform, Rotation

Array = NDArray[np.float64]

MM = 1e-3


def from_written(xyz_mm_abc_deg: Sequence[float]) -> RigidTransform:
    """Pose from x, y, z in mm and A, B, C in degrees, R = Rz(A) Ry(B) Rx(C)."""
    x, y, z, a, b, c = xyz_mm_abc_deg
    rotation = Rotation.from_euler("ZYX", [a, b, c], degrees=True)
    return RigidTransform.from_components(np.array([x, y, z]) * MM, rotation)


def written_matrix(xyz_mm_abc_deg: Sequence[float]) -> Array:
    """The same as a 4x4 matrix, in plain floats because a stream brings hundreds a second."""
    x, y, z, *angles_deg = xyz_mm_abc_deg
    ca, cb, cc = (cos(radians(angle)) for angle in angles_deg)
    sa, sb, sc = (sin(radians(angle)) for angle in angles_deg)
    return np.array(
        [
            [ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc, x * MM],
            [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc, y * MM],
            [-sb, cb * sc, cb * cc, z * MM],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def to_written(pose: RigidTransform) -> list[float]:
    """x, y, z in mm and A, B, C in degrees."""
    return matrix_to_written(pose.as_matrix())


def matrix_to_written(matrix: Array) -> list[float]:
    """The same from a 4x4 matrix, in plain floats because controllers report 200 times a second."""
    (r00, r01, _, x), (r10, r11, _, y), (r20, r21, r22, z), _ = matrix.tolist()
    level = hypot(r00, r10)
    b = atan2(-r20, level)
    a, c = (atan2(r10, r00), atan2(r21, r22)) if level > 1e-9 else (atan2(-r01, r11), 0.0)
    return [x / MM, y / MM, z / MM, degrees(a), degrees(b), degrees(c)]


def displacement(translation_m: ArrayLike, rotation_rad: ArrayLike) -> RigidTransform:
    """Small displacement: a translation and a rotation vector."""
    return RigidTransform.from_components(
        np.asarray(translation_m, dtype=float),
        Rotation.from_rotvec(np.asarray(rotation_rad, dtype=float)),
    )


def distance(one: RigidTransform, other: RigidTransform) -> tuple[float, float]:
    """Distance (m) and angle (rad) between two poses of one parent frame."""
    delta = one.inv() * other
    return float(np.linalg.norm(delta.translation)), float(delta.rotation.magnitude())


def inverse_matrix(matrix: Array) -> Array:
    """Inverse of a pose; both are 4x4 matrices."""
    inverted = np.eye(4)
    inverted[:3, :3] = matrix[:3, :3].T
    inverted[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return inverted


def matrix_distance(one: Array, other: Array) -> tuple[float, float]:
    """The same between two 4x4 matrices."""
    difference = one - other
    # Two rotations that differ by an angle have matrices that differ by sqrt(8) sin(angle / 2).
    chord = float(np.linalg.norm(difference[:3, :3])) / sqrt(8.0)
    return float(np.linalg.norm(difference[:3, 3])), 2.0 * asin(min(chord, 1.0))


def stream(seed: int, *names: str | int) -> np.random.Generator:
    """A random stream of its own for every thing that is drawn, so that draws stay independent."""
    # Python salts ``hash`` anew in every process, but a seed has to reproduce its cell.
    keys = [name if isinstance(name, int) else crc32(name.encode()) for name in names]
    return np.random.default_rng(np.random.SeedSequence([seed, *keys]))


def stream_seed(seed: int, *names: str | int) -> int:
    """A number for a stream that is made elsewhere, as in the renderer."""
    return int(stream(seed, *names).integers(2**31))
