"""A move as joints in small steps: what the controller will do between its two ends."""

import math

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from cellctl.config.stated_moves import MoveKind, StatedMove, StatedPlace
from cellctl.config.via_points import via_points
from cellctl.errors.planning import PlaceUnreachable
from cellctl.geometry.pose import Array, pose_to_xyzabc
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.ways.reaching import joints_reaching

_STEP_M = 0.005
_STEP_RAD = math.radians(0.5)
_JUMP_RAD = math.radians(20.0)
"""More than this within one step of the flange: the arm would have to fold over."""


def joints_at(arm: PlannedArm, place: StatedPlace) -> Array:
    """Joints of a place, shape (6,); raises ``PlaceUnreachable``."""
    joints_rad: Array | None = place.joints_rad
    if place.base_T_flange is not None:
        joints_rad = joints_reaching(arm, place.base_T_flange, place.joints_rad)
        if joints_rad is None:
            written = np.round(pose_to_xyzabc(place.base_T_flange), 1).tolist()
            raise PlaceUnreachable(f"{arm.name}: {place.label}, flange at {written}: out of reach")
    assert joints_rad is not None
    refusal = arm.refusal(joints_rad)
    if refusal is not None:
        raise PlaceUnreachable(f"{arm.name}: {place.label}: {refusal}")
    return joints_rad


def polyline(arm: PlannedArm, move: StatedMove) -> Array:
    """Joints of shape (n, 6), straight between which the arm goes; raises ``PlaceUnreachable``.

    A joint move is straight already, from point to point of a way that the cell file states. The
    flange of a linear move is straight to within what its small steps leave.
    """
    start_rad, end_rad = joints_at(arm, move.start), joints_at(arm, move.end)
    if move.kind is MoveKind.JOINT:
        via = via_points(arm.config, start_rad, move.end.label)
        return np.vstack([start_rad, *via, end_rad])
    return _linear(arm, move, start_rad)


def _linear(arm: PlannedArm, move: StatedMove, start_rad: Array) -> Array:
    begin = arm.base_T_flange(start_rad)
    end = move.end.base_T_flange
    if end is None:
        end = arm.base_T_flange(move.end.joints_rad)
    way_m = float(np.linalg.norm(end.translation - begin.translation))
    turn_rad = float((begin.rotation.inv() * end.rotation).magnitude())
    count = max(1, math.ceil(way_m / _STEP_M), math.ceil(turn_rad / _STEP_RAD))
    turns = Slerp([0.0, 1.0], Rotation.concatenate([begin.rotation, end.rotation]))
    joints = [start_rad]
    for share in np.linspace(0.0, 1.0, count + 1)[1:]:
        at_m = (1.0 - share) * begin.translation + share * end.translation
        pose = RigidTransform.from_components(at_m, turns(share))
        found = joints_reaching(arm, pose, joints[-1])
        if found is None or np.abs(found - joints[-1]).max() > _JUMP_RAD:
            raise PlaceUnreachable(f"{move.name}: out of reach {share:.0%} of the way")
        joints.append(found)
    return np.array(joints)
