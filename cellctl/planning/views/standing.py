"""Whether an arm can hold its head somewhere: reach, margins of the joints, room around it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.arm.chain import flange_jacobian
from cellctl.geometry.arm.reaching import joints_reaching
from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.scene.surroundings import Surroundings

OUT_OF_REACH = "the arm does not reach there"
NEAR_A_LIMIT = "a joint or the flange is too near to its limit"
SINGULAR = "the arm is near a singular pose"
VIEWS_OUT_OF_REACH = "a view of the calibration is out of reach from there"
_LEAST_SINGULAR = 0.08
"""Least singular value of the Jacobian with turns over half a metre. At the wrist's and the elbow's
singular poses it is 0; 0.08 means that the flange's 250 mm/s ask at most 180 °/s of a joint."""
_LEVER_M = 0.5
"""Lever by which turns count as lengths, so that all rows of the Jacobian have one unit."""


@dataclass(frozen=True, slots=True, eq=False)
class HeldHead:
    """Joints at which an arm may stand, or why there are none."""

    joints_rad: Array | None
    why_not: str | None


def standing_at(
    arm: PlannedArm, around: Surroundings, cell_T_flange: RigidTransform, near_rad: Array
) -> HeldHead:
    """The arm with its flange at a pose, folded as at ``near_rad``, shape (6,)."""
    base_T_flange = (arm.cell_T_base.inv() * cell_T_flange).as_matrix()
    joints_rad = joints_reaching(arm.chain, base_T_flange, _turned(arm, base_T_flange, near_rad))
    if joints_rad is None:
        return HeldHead(None, OUT_OF_REACH)
    joints_rad = _unwound(arm, joints_rad)
    if _least_singular(arm, joints_rad) < _LEAST_SINGULAR:
        return HeldHead(None, SINGULAR)
    margin_rad = arm.joint_margin_rad
    if around.refusal(joints_rad) is not None or any(
        arm.refusal(joints_rad + sign * margin_rad * axis) is not None
        for axis in np.eye(6)
        for sign in (1.0, -1.0)
    ):
        return HeldHead(None, NEAR_A_LIMIT)
    if not around.has_room(joints_rad, 0.0):
        gap = around.narrowest(joints_rad)
        return HeldHead(None, f"{gap.first} is too near to {gap.second}")
    return HeldHead(joints_rad, None)


def reaches_views(
    arm: PlannedArm, joints_rad: Array, flange_T_views: Sequence[RigidTransform]
) -> bool:
    """Whether the arm, folded as at joints of shape (6,), reaches places seen from its flange."""
    base_T_flange = arm.base_T_flange(joints_rad)
    for flange_T_view in flange_T_views:
        view = (base_T_flange * flange_T_view).as_matrix()
        at_view_rad = joints_reaching(arm.chain, view, joints_rad)
        if at_view_rad is None or arm.refusal(at_view_rad) is not None:
            return False
    return True


def _turned(arm: PlannedArm, base_T_flange: Array, near_rad: Array) -> Array:
    """A start of the search with the last joint turned as the pose asks for.

    Half a turn of a head about its line of sight is mostly one of the last joint; a search that has
    to find it by small steps may end in another fold of the arm.
    """
    here = arm.chain.link_frames(near_rad)[6][:3, :3]
    between = here.T @ base_T_flange[:3, :3]
    start_rad = near_rad.copy()
    start_rad[5] += np.arctan2(between[1, 0] - between[0, 1], between[0, 0] + between[1, 1])
    return start_rad


def _unwound(arm: PlannedArm, joints_rad: Array) -> Array:
    """Each joint by whole turns as near to the middle of its limits as can be."""
    middle_rad = (arm.chain.lower_rad + arm.chain.upper_rad) / 2
    turns = np.round((middle_rad - joints_rad) / (2.0 * np.pi))
    return np.asarray(joints_rad + 2.0 * np.pi * turns)


def _least_singular(arm: PlannedArm, joints_rad: Array) -> float:
    jacobian = flange_jacobian(arm.chain.link_frames(joints_rad))
    scaled = np.vstack([jacobian[:3], _LEVER_M * jacobian[3:]])
    return float(np.linalg.svd(scaled, compute_uv=False)[-1])
