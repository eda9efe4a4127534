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
"""On its way out an arm may come back by so much from the nearest that it was to the face, as by
its rounded joints."""


class Way(Protocol):
    """What the arbiter asks about a move."""

    def needs(self, share: Share) -> bool:
        """Whether the arm may come into the robot's share of a zone, its start included."""
        ...

    def ends_in(self, share: Share) -> bool:
        """Whether the arm may stand in it at the end."""
        ...

    def leads_out(self, share: Share) -> bool:
        """Whether it begins in the share and leads out through the face that is the way out: always
        towards that face until it is beyond it, and never back into the share."""
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
        # any side, as a second move from there might. What is not a number fails either way.
        first = beyond[0]
        # From the nearest so far and not from point to point, of which a joint move has many.
        until_face_m = before_face_m[: first + 1]
        towards = np.all(until_face_m - np.minimum.accumulate(until_face_m) <= WAVER_M)
        return bool(towards and not share.box.meets(self.points_m[first:]))


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
