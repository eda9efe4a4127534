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
from math import acos, atan2, cos, hypot, sin, tau

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario_file.sections import Chain
from fakes.world.frames import MM, Array

_FIRST, _SECOND = np.array([[0, 2, 2, 1, 2, 1], [1, 0, 0, 2, 0, 2]])
"""The two coordinates that each joint mixes: z, y, y, x, y, x are the axes."""


def _turns() -> tuple[Array, Array, Array]:
    """The turn of each joint is the first, plus its cosine times the second, plus its sine times
    the third; each of shape (6, 4, 4).

    Constants in place of a rotation for each joint, because the forward kinematics of every arm
    are computed in every millisecond of its motion.
    """
    each, fixed = np.arange(6), np.tile(np.eye(4), (6, 1, 1))
    cosine, sine = np.zeros((2, 6, 4, 4))
    fixed[each, _FIRST, _FIRST] = fixed[each, _SECOND, _SECOND] = 0.0
    cosine[each, _FIRST, _FIRST] = cosine[each, _SECOND, _SECOND] = 1.0
    sine[each, _SECOND, _FIRST], sine[each, _FIRST, _SECOND] = 1.0, -1.0
    return fixed, cosine, sine


_TURN_FIXED, _TURN_COSINE, _TURN_SINE = _turns()
_FLANGE = Rotation.from_euler("y", 90, degrees=True)
_SINGULAR_RAD = np.deg2rad(0.5)
"""A5 nearer than this to zero counts as singular; assumed, as controllers state no figure."""


class OutOfReachError(ValueError):
    """The wrist centre lies outside the arm's reach."""


@dataclass(frozen=True, slots=True, eq=False)
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
    """The chain as it was built. The real first axis defines the base, so link 0 is exact."""
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
    angles = (joints_rad + links.joint_offsets_rad)[:, np.newaxis, np.newaxis]
    turns = _TURN_FIXED + np.cos(angles) * _TURN_COSINE + np.sin(angles) * _TURN_SINE
    result: Array = links.matrices[0]
    for step in turns @ links.matrices[1:]:
        result = result @ step
    return result


def forward(links: Links, joints_rad: Array) -> RigidTransform:
    """base_T_flange."""
    return RigidTransform.from_matrix(forward_matrix(links, joints_rad))


def inverse(chain: Chain, base_T_flange: RigidTransform, near_rad: Array) -> Array:
    """Joint angles of the nominal chain, of all solutions the one nearest to ``near_rad``.

    Raises ``OutOfReachError``. Does not look at joint limits.
    """
    rotation = base_T_flange.rotation.as_matrix()
    wrist_mm = (base_T_flange.translation / MM - chain.d6 * rotation[:, 2]).tolist()
    tool = (rotation @ _FLANGE.as_matrix().T).tolist()
    near = near_rad.tolist()
    solutions = [
        _nearest_turn([*arm, *wrist], near)
        for shoulder, elbow in product((1, -1), (1, -1))
        if (arm := _arm_angles(chain, wrist_mm, shoulder, elbow)) is not None
        for wrist in _wrist_angles(arm, tool, near[5])
    ]
    if not solutions:
        raise OutOfReachError("the wrist centre is out of reach")
    return np.array(min(solutions, key=lambda joints: _gap(joints, near)))


def singular(joints_rad: Array) -> bool:
    """True near the wrist singularity, where A4 and A6 coincide."""
    return bool(abs(joints_rad[4]) < _SINGULAR_RAD)


def _arm_angles(
    chain: Chain, wrist_mm: list[float], shoulder: int, elbow: int
) -> tuple[float, float, float] | None:
    x, y, z = wrist_mm
    q1 = atan2(shoulder * y, shoulder * x)
    out, up = shoulder * hypot(x, y) - chain.a1, z - chain.d1
    forearm, reach = hypot(chain.d4, chain.elbow), hypot(out, up)
    cosine = (reach**2 - chain.a2**2 - forearm**2) / (2 * chain.a2 * forearm)
    if abs(cosine) > 1:
        return None
    bend = elbow * acos(cosine)
    q2 = -atan2(up, out) - atan2(forearm * sin(bend), chain.a2 + forearm * cos(bend))
    return q1, q2, bend + atan2(chain.elbow, chain.d4)


def _wrist_angles(
    arm: tuple[float, float, float], tool: list[list[float]], near_q6: float
) -> list[tuple[float, float, float]]:
    """A4, A5, A6 from forearm_R_tool = Rx(A4) Ry(A5) Rx(A6)."""
    c1, s1, c23, s23 = cos(arm[0]), sin(arm[0]), cos(arm[1] + arm[2]), sin(arm[1] + arm[2])
    axes = ((c1 * c23, s1 * c23, -s23), (-s1, c1, 0.0), (c1 * s23, s1 * s23, c23))
    (xx, xy, xz), (yx, yy, _), (zx, zy, _) = (
        [sum(axis[i] * tool[i][column] for i in range(3)) for column in range(3)] for axis in axes
    )
    bend = atan2(hypot(xy, xz), xx)
    # A4 and A6 turn about one axis there, and only their sum is known: A6 stays where it was.
    if abs(sin(bend)) < 1e-9:
        return [(atan2(zy, yy) - near_q6, bend, near_q6)]
    return [
        (atan2(sign * yx, -sign * zx), sign * bend, atan2(sign * xy, sign * xz)) for sign in (1, -1)
    ]


def _nearest_turn(joints: list[float], near: list[float]) -> list[float]:
    # The same posture a whole turn away is another place of the joint, which a controller does not
    # jump to.
    return [q + tau * round((n - q) / tau) for q, n in zip(joints, near, strict=True)]


def _gap(joints: list[float], near: list[float]) -> float:
    return max(abs(q - n) for q, n in zip(joints, near, strict=True))
