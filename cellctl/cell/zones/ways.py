"""The way of a move before it begins: which zones it needs, and in which it ends."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.cell.zones.zone import Share
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import Array
from cellctl.interfaces import RobotState
from cellctl.interfaces.robot import ForwardKinematics

GREATEST_RAD = 4.0 * np.pi
"""No joint of an arm turns further from its zero: twice the ±360° of data sheets."""
WAVER_M = 0.001
"""On its way out an arm may fall behind by so much, as by its rounded joints."""
LEAST_GAIN = 0.05
"""Share of each stretch of a way out by which it must come nearer to the face.

What stands beside an arm is in its way when it goes to the side, and the arbiter does not know
where. Ways home are oblique all the same: that of the shipped deck cell rises by half a metre to
home, and from near the face it gains 0.085 of its length at least, from 0.1 m before it 0.2 and
from 0.3 m 0.4 (``tests/unit/cell/zones/test_ways_home.py``).
"""
DETOUR_M = 0.45
"""A way out may be so much longer than the shortest one, which is straight to the face.

Without it an arm deep in its box could go to the side for metres and gain its share. The ways home
of the shipped deck cell take 0.41 m at most.
"""


class Way(Protocol):
    """What the arbiter asks about a move."""

    def needs(self, share: Share) -> bool:
        """Whether the arm may come into the robot's share of a zone, its start included."""
        ...

    def ends_in(self, share: Share) -> bool:
        """Whether the arm may stand in it at the end."""
        ...

    def leads_out(self, share: Share) -> bool:
        """Whether it begins in the share and leads out through the face that is the way out: nearer
        to that face on every stretch until it is beyond it, without a long way round, and never
        back into the share."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class FlangeWay:
    """The flange goes straight from point to point."""

    points_m: Array
    """Shape (n, 3), in the base of the robot; the first one is where the flange is."""
    reach_m: float = 0.0
    """How far from these lines it may come."""

    def needs(self, share: Share) -> bool:
        """Whether the lines come that near to the box."""
        return share.box.grown(self.reach_m).meets(self.points_m)

    def ends_in(self, share: Share) -> bool:
        """Whether the last point lies that near to the box."""
        return share.box.grown(self.reach_m).holds(self.points_m[-1])

    def leads_out(self, share: Share) -> bool:
        """Judged by its points, between which the way is straight; False for one that may leave its
        lines."""
        if share.way_out is None or self.reach_m > 0.0 or not share.box.holds(self.points_m[0]):
            return False
        axis, upper = share.way_out
        before_face_m = share.box.to_face_m(self.points_m, axis, upper=upper)
        beyond = np.flatnonzero(before_face_m < 0.0)
        if not beyond.size:
            return False
        # Outside of its box no part of the arm reaches into the zone, so that it may then turn to
        # any side, as a second move from there might.
        first = beyond[0]
        until_face_m = _cut(self.points_m[: first + 1], before_face_m[: first + 1])
        gains = _gains(until_face_m, share.box.to_face_m(until_face_m, axis, upper=upper))
        return bool(gains and not share.box.meets(self.points_m[first:]))


def _cut(points_m: Array, before_face_m: Array) -> Array:
    """Points of which the last one alone lies beyond the face, up to the face."""
    share = before_face_m[-2] / (before_face_m[-2] - before_face_m[-1])
    end_m = points_m[-2] + share * (points_m[-1] - points_m[-2])
    return np.vstack([points_m[:-1], end_m])


def _gains(points_m: Array, before_face_m: Array) -> bool:
    """Whether a way leads to the face and not along it; what is not a number does not."""
    steps_m = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    length_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    # Each stretch of the way, and not each step from point to point, of which a joint move has
    # many: a loss of less than the waver at each of them would add up.
    behind_m = before_face_m + LEAST_GAIN * length_m
    keeps_up = np.all(behind_m - np.minimum.accumulate(behind_m) <= WAVER_M)
    return bool(keeps_up and length_m[-1] - before_face_m[0] <= DETOUR_M)


@dataclass(frozen=True, slots=True, eq=False)
class UnknownWay:
    """A joint move of an arm whose kinematics are not known: the taught poses decide."""

    here_m: Array
    """Where the flange is now, shape (3,)."""
    start_rad: Array
    target_rad: Array

    def needs(self, share: Share) -> bool:
        """Whether it is anything but a move from one clear pose to another."""
        between = share.is_clear(self.start_rad) and share.is_clear(self.target_rad)
        return share.box.holds(self.here_m) or not between

    def ends_in(self, share: Share) -> bool:
        """Whether the target is anything but a clear pose."""
        return not share.is_clear(self.target_rad)

    def leads_out(self, share: Share) -> bool:  # noqa: ARG002
        """Never: between its taught poses the way is not known."""
        return False


def linear_way(state: RobotState, base_T_flange: RigidTransform) -> FlangeWay:
    """A straight move from where the flange is."""
    return FlangeWay(np.vstack([state.base_T_flange.translation, base_T_flange.translation]))


def stream_way(state: RobotState, travel_m: float) -> FlangeWay:
    """Setpoints that may come anywhere so near to where the flange is."""
    return FlangeWay(state.base_T_flange.translation[None], travel_m)


def joint_way(state: RobotState, joints_rad: Array, kinematics: ForwardKinematics | None) -> Way:
    """A joint move to shape (6,), by forward kinematics where there are some."""
    here_m, target_rad = state.base_T_flange.translation, np.asarray(joints_rad, dtype=float)
    # A target that no arm can have is left to the driver, which refuses it. Until then it needs
    # every zone. Written so that what is not a number counts as such a target.
    possible = target_rad.shape == (6,) and bool(np.all(np.abs(target_rad) <= GREATEST_RAD))
    if not possible:
        return UnknownWay(here_m, state.joints_rad, np.full(6, np.nan))
    if kinematics is None:
        return UnknownWay(here_m, state.joints_rad, target_rad)
    path = joint_path(state.joints_rad, target_rad)
    # What the robot reports comes first: a move from a place in the zone needs it, whatever the
    # kinematics make of the joints.
    return FlangeWay(np.vstack([here_m, *(kinematics(at).translation for at in path)]))
