"""A move as joints in small steps: what the controller will do between its two ends."""

import math
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.config.via_points import via_points
from cellctl.errors.config import PlaceUnreachable
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.arm.linear_way import BrokenWay, WaySteps, linear_joint_way
from cellctl.geometry.arm.reaching import joints_reaching
from cellctl.geometry.pose import Array, pose_to_xyzabc
from cellctl.planning.scene.arm import PlannedArm

_STEPS = WaySteps(way_m=0.005, turn_rad=math.radians(0.5), jump_rad=math.radians(20.0))
"""Finer than the driver's own check of a straight way: nothing waits for the planning."""


def joints_at(arm: PlannedArm, place: StatedPlace) -> Array:
    """Joints of a place, shape (6,); raises ``PlaceUnreachable``."""
    joints_rad: Array | None = place.joints_rad
    if place.base_T_flange is not None:
        joints_rad = joints_reaching(arm.chain, place.base_T_flange.as_matrix(), place.joints_rad)
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
    end = move.end.base_T_flange
    if end is None:
        # A place that is taught by joints: the line goes to where these put the flange.
        end = arm.base_T_flange(move.end.joints_rad)
    way = _line(arm.chain, start_rad.tobytes(), end.as_matrix().tobytes())
    if isinstance(way, BrokenWay):
        raise PlaceUnreachable(f"{move.name}: {way.why} {way.share:.0%} of the way")
    return way


# The moves of a cell are looked at one by one, and once more for each pair of arms that share a
# zone. To follow a line takes longer than to measure the gaps beside it.
@lru_cache(maxsize=2048)
def _line(chain: ArmChain, start_rad: bytes, end: bytes) -> Array | BrokenWay:
    """The joints on a straight way, between numbers as bytes: shapes (6,) and (4, 4)."""
    target = RigidTransform.from_matrix(np.frombuffer(end).reshape(4, 4))
    way = linear_joint_way(chain, np.frombuffer(start_rad), target, _STEPS)
    if not isinstance(way, BrokenWay):
        way.setflags(write=False)
    return way
