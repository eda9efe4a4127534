"""A straight way of the flange as joints: whether the arm can follow it, and what its joints do."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.arm.chain import ArmChain, flange_jacobian
from cellctl.geometry.arm.reaching import joints_reaching
from cellctl.geometry.pose import Array

SINGULAR = 0.01
"""Least singular value of the Jacobian of the flange, with lengths in lengths of the arm. Here some
turn or way of the flange needs a hundredfold turn of a joint: the wrist of a usual arm is about 2
degrees from straight. Controllers refuse such a way, or leave it because a joint cannot follow."""


@dataclass(frozen=True, slots=True)
class WaySteps:
    """How finely a straight way is looked at."""

    way_m: float
    turn_rad: float
    """The flange goes and turns no further than this from point to point."""
    jump_rad: float
    """A joint that turns further from point to point is one of an arm that folds over."""
    at_most: int = 100_000
    """Points; a way too long for them is looked at more coarsely."""

    def count(self, way_m: Array, turn_rad: Array) -> int:
        """Points after the start of a way (m) with a rotation vector (rad), both of shape (3,)."""
        steps = np.linalg.norm(way_m) / self.way_m, np.linalg.norm(turn_rad) / self.turn_rad
        return min(max(1, math.ceil(max(steps))), self.at_most)


@dataclass(frozen=True, slots=True)
class BrokenWay:
    """The place at which the arm can no longer follow a way."""

    share: float
    """Share of the way up to there, 0 to 1."""
    why: str
    """The reason in words."""


def linear_joint_way(
    chain: ArmChain, start_rad: Array, base_T_target: RigidTransform, steps: WaySteps
) -> Array | BrokenWay:
    """Joints of shape (n, 6), the start included, with the flange on the straight way to a pose.

    The flange goes straight and turns evenly about one axis, both together, as controllers of arms
    do it. Joint limits are not looked at. ``start_rad`` has shape (6,).
    """
    begin, end = chain.link_frames(start_rad)[6], base_T_target.as_matrix()
    way_m = end[:3, 3] - begin[:3, 3]
    turn = Rotation.from_matrix(end[:3, :3] @ begin[:3, :3].T).as_rotvec()
    shares = np.linspace(0.0, 1.0, steps.count(way_m, turn) + 1)[1:]
    poses = np.tile(begin, (len(shares), 1, 1))
    poses[:, :3, 3] += np.outer(shares, way_m)
    poses[:, :3, :3] = Rotation.from_rotvec(np.outer(shares, turn)).as_matrix() @ begin[:3, :3]
    joints, (_, side) = [start_rad], nearness_to_singular(chain, start_rad)
    for share, pose in zip(shares, poses, strict=True):
        found = joints_reaching(chain, pose, joints[-1])
        if found is None:
            return BrokenWay(float(share), "out of reach")
        if np.abs(found - joints[-1]).max() > steps.jump_rad:
            return BrokenWay(float(share), "the arm would have to fold over")
        least, sign = nearness_to_singular(chain, found)
        # Between two points on different sides lies a singular pose, however far both are from it.
        if least < SINGULAR or sign * side < 0.0:
            return BrokenWay(float(share), "the arm comes through a singular pose")
        joints.append(found)
        side = sign
    return np.array(joints)


def nearness_to_singular(chain: ArmChain, joints_rad: Array) -> tuple[float, float]:
    """Least singular value of the flange's Jacobian at joints of shape (6,), and the sign of its
    determinant, which tells the two sides of a singular pose.

    The value tells how far the arm is from such a pose (Yoshikawa, Int. J. Robotics Research 4
    (1985) 3). Lengths count in lengths of the arm, so that ways and turns can be compared.
    """
    slope = flange_jacobian(chain.link_frames(joints_rad))
    slope[:3] /= chain.length_m
    least = float(np.linalg.svd(slope, compute_uv=False)[-1])
    return least, float(np.sign(np.linalg.det(slope)))
