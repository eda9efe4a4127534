"""A six-axis arm with a spherical wrist: nominal kinematics as its controller believes them, and
true kinematics with small errors in every link.

Joint convention (ours; the written chains are stand-ins, not SIASUN data). At all zeros the arm is
stretched along x of its base. A1 turns about +z of the base. A2 (height d1, radius a1) and A3 (a2
further out) turn about +y: positive lowers the arm. The forearm lies ``elbow`` above A3 and is d4
long. A4 turns about the forearm, A5 about +y, A6 about the flange. The flange z axis points
outward, its x axis down at zero.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario import Chain
from fakes.world.frames import MM, Array

_AXES = np.array([[0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0]], dtype=float)
_FLANGE = Rotation.from_euler("y", 90, degrees=True)
_SINGULAR_RAD = np.deg2rad(0.5)


class Unreachable(ValueError):
    """The wrist centre lies outside the arm's reach."""


@dataclass(frozen=True, slots=True)
class Links:
    """Fixed transforms of a chain: before the first joint and after each joint, shape (7, 4, 4)."""

    matrices: Array
    joint_offsets_rad: Array


def nominal_links(chain: Chain) -> Links:
    """The chain as it is written."""
    steps = [
        (0, 0, 0), (chain.a1, 0, chain.d1), (chain.a2, 0, 0), (chain.d4, 0, chain.elbow),
        (0, 0, 0), (0, 0, 0), (chain.d6, 0, 0),
    ]  # fmt: skip
    matrices = np.tile(np.eye(4), (7, 1, 1))
    matrices[:, :3, 3] = np.array(steps, dtype=float) * MM
    matrices[6, :3, :3] = _FLANGE.as_matrix()
    return Links(matrices, np.zeros(6))


def perturbed_links(
    chain: Chain, rng: np.random.Generator, sigma_m: float, sigma_rad: float, joint_rad: float
) -> Links:
    """The chain as it was built. The base frame is defined by the real first axis, so link 0 is exact."""
    nominal = nominal_links(chain)
    matrices = nominal.matrices.copy()
    for index in range(1, 7):
        error = RigidTransform.from_components(
            rng.normal(0, sigma_m, 3), Rotation.from_rotvec(rng.normal(0, sigma_rad, 3))
        )
        matrices[index] = matrices[index] @ error.as_matrix()
    return Links(matrices, rng.normal(0, joint_rad, 6))


def forward_matrix(links: Links, joints_rad: Array) -> Array:
    """base_T_flange as a 4x4 matrix."""
    result = links.matrices[0]
    angles = joints_rad + links.joint_offsets_rad
    cosines, sines = np.cos(angles).tolist(), np.sin(angles).tolist()
    for index, (c, s) in enumerate(zip(cosines, sines, strict=True)):
        turn = np.eye(4)
        first, second = _PLANES[index]
        turn[first, first] = turn[second, second] = c
        turn[second, first] = s
        turn[first, second] = -s
        result = result @ turn @ links.matrices[index + 1]
    return result


_PLANES = [((1, 2), (2, 0), (0, 1))[int(np.argmax(axis))] for axis in _AXES]
"""The two axes that a joint mixes: (y, z) about x, (z, x) about y, (x, y) about z."""


def forward(links: Links, joints_rad: Array) -> RigidTransform:
    """base_T_flange."""
    return RigidTransform.from_matrix(forward_matrix(links, joints_rad))


def inverse(chain: Chain, base_T_flange: RigidTransform, near_rad: Array) -> Array:
    """Joint angles of the nominal chain, of all solutions the one nearest to ``near_rad``.

    Raises ``Unreachable``. Does not look at joint limits.
    """
    wrist = base_T_flange.apply(np.array([0.0, 0.0, -chain.d6 * MM]))
    base_R_forearm_zero = base_T_flange.rotation * _FLANGE.inv()
    best, best_distance = None, np.inf
    for shoulder, elbow in product((1, -1), (1, -1)):
        arm = _arm_angles(chain, wrist, shoulder, elbow)
        if arm is None:
            continue
        for wrist_angles in _wrist_angles(arm, base_R_forearm_zero, near_rad):
            joints = _nearest_turn(np.array([*arm, *wrist_angles]), near_rad)
            gap = float(np.abs(joints - near_rad).max())
            if gap < best_distance:
                best, best_distance = joints, gap
    if best is None:
        raise Unreachable("the wrist centre is out of reach")
    return best


def singular(joints_rad: Array) -> bool:
    """True near the wrist singularity, where A4 and A6 coincide."""
    return bool(abs(joints_rad[4]) < _SINGULAR_RAD)


def _arm_angles(
    chain: Chain, wrist: Array, shoulder: int, elbow: int
) -> tuple[float, float, float] | None:
    x, y, z = wrist / MM
    q1 = np.arctan2(shoulder * y, shoulder * x)
    out, up = shoulder * np.hypot(x, y) - chain.a1, z - chain.d1
    forearm, reach = np.hypot(chain.d4, chain.elbow), np.hypot(out, up)
    cosine = (reach**2 - chain.a2**2 - forearm**2) / (2 * chain.a2 * forearm)
    if abs(cosine) > 1:
        return None
    bend = elbow * np.arccos(cosine)
    lift = np.arctan2(up, out)
    q2 = -lift - np.arctan2(forearm * np.sin(bend), chain.a2 + forearm * np.cos(bend))
    return float(q1), float(q2), float(bend + np.arctan2(chain.elbow, chain.d4))


def _wrist_angles(
    arm: tuple[float, float, float], base_R_tool: Rotation, near_rad: Array
) -> list[tuple[float, float, float]]:
    q1, q2, q3 = arm
    base_R_forearm = Rotation.from_euler("ZY", [q1, q2 + q3])
    rest = (base_R_forearm.inv() * base_R_tool).as_matrix()
    bend = np.arctan2(np.hypot(rest[0, 1], rest[0, 2]), rest[0, 0])
    if abs(np.sin(bend)) < 1e-9:
        q6 = float(near_rad[5])
        turn = np.arctan2(rest[2, 1], rest[1, 1])
        return [(float(turn - q6), float(bend), q6)]
    solutions = []
    for sign in (1, -1):
        q4 = np.arctan2(sign * rest[1, 0], -sign * rest[2, 0])
        q6 = np.arctan2(sign * rest[0, 1], sign * rest[0, 2])
        solutions.append((float(q4), float(sign * bend), float(q6)))
    return solutions


def _nearest_turn(joints: Array, near: Array) -> Array:
    return joints + 2 * np.pi * np.round((near - joints) / (2 * np.pi))
