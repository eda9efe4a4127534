"""One arm among everything that stands still while it moves: how near it comes at given joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import fcl
import numpy as np

from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.scene.nearest import NarrowestGap
from cellctl.planning.scene.solid import Solid

Clearances = Mapping[frozenset[str], float]
"""Clearances in m, for pairs of bodies that a process brings together."""

_MEETING_M = -1e-9
"""Distance of bodies that meet: less than nothing, so that no margin of 0 lets them."""
_WITH_POINTS = fcl.DistanceRequest(enable_nearest_points=True)


@dataclass(frozen=True, slots=True, eq=False)
class StandingSolid:
    """A body where it stands while the arm moves."""

    solid: Solid
    cell_T_shape: Array
    """Shape (4, 4)."""
    label: str
    """What a finding calls it: a body of another arm with the place at which that arm stands."""


class Surroundings:
    """The distances of one arm's bodies to what stands around it and to each other."""

    def __init__(
        self,
        arm: PlannedArm,
        moving: Sequence[Solid],
        standing: Sequence[StandingSolid],
        clearances: Clearances,
        closed: Mapping[str, Box],
    ) -> None:
        """``closed``: zones by name in which another arm stands, in the base of this one."""
        self.arm = arm
        self._closed = closed
        self._moving = moving
        self._offsets = np.array([solid.link_T_shape for solid in moving])
        self._links = np.array([solid.link for solid in moving])
        self._movers = [fcl.CollisionObject(solid.shape.geometry()) for solid in moving]
        self._others = list(standing)
        self._standers = [_placed(one) for one in standing]
        pairs = list(_pairs(moving, standing, clearances))
        self._first = np.array([pair[0] for pair in pairs], dtype=int)
        self._second = np.array([pair[1] for pair in pairs], dtype=int)
        self._required = np.array([pair[2] for pair in pairs])
        radii = np.array(
            [solid.shape.radius_m for solid in moving]
            + [one.solid.shape.radius_m for one in standing]
        )
        self._balls = radii[self._first] + radii[self._second]
        self._still_at = np.array([one.cell_T_shape[:3, 3] for one in standing]).reshape(-1, 3)
        self.lever_m = np.max(
            [arm.lever_m(solid.link, _reach_m(solid)) for solid in moving], axis=0
        )
        """The greatest distance of any body of the arm from the axis of each joint, shape (6,)."""

    def refusal(self, joints_rad: Array) -> str | None:
        """Why the arm would not be let there at joints of shape (6,), by its driver or the arbiter
        of the zones; None when it would."""
        flange_m = self.arm.chain.flange_m(joints_rad)
        for zone, box in self._closed.items():
            if box.holds(flange_m):
                return f"its flange comes into zone {zone}, in which another arm stands"
        return self.arm.refusal(joints_rad)

    def narrowest(self, joints_rad: Array) -> NarrowestGap:
        """The pair with the least slack at joints of shape (6,)."""
        least_m = self._least_slack_m(joints_rad)
        best_m, best, found = np.inf, -1, fcl.DistanceResult()
        for pair in np.argsort(least_m).tolist():
            # No later pair can have less.
            if least_m[pair] >= best_m:
                break
            result = fcl.DistanceResult()
            slack_m = self._distance_m(pair, result) - self._required[pair]
            if slack_m < best_m:
                best_m, best, found = slack_m, pair, result
        if best < 0:
            raise ValueError("a scene without any pair of bodies has no distances")
        first, second = self._first[best], self._second[best]
        required_m = float(self._required[best])
        place_m = self._place_m(best, found, touching=best_m + required_m <= 0.0)
        distance_m = best_m + required_m
        return NarrowestGap(
            self._label(first), self._label(second), distance_m, required_m, place_m
        )

    def has_room(self, joints_rad: Array, slack_m: float) -> bool:
        """Whether every pair has this much slack at joints of shape (6,); quicker than to measure
        the narrowest."""
        least_m = self._least_slack_m(joints_rad)
        near = np.flatnonzero(least_m < slack_m)
        # The likeliest to meet first.
        return all(
            self._distance_m(pair, fcl.DistanceResult()) - self._required[pair] >= slack_m
            for pair in near[np.argsort(least_m[near])].tolist()
        )

    def _least_slack_m(self, joints_rad: Array) -> Array:
        """What no pair has less than, by the balls around its bodies; places all bodies."""
        poses = self.arm.link_frames(joints_rad)[self._links] @ self._offsets
        for mover, pose in zip(self._movers, poses, strict=True):
            mover.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        at = np.vstack([poses[:, :3, 3], self._still_at])
        way = at[self._first] - at[self._second]
        return np.asarray(np.sqrt((way * way).sum(axis=1)) - self._balls - self._required)

    def _distance_m(self, pair: int, result: fcl.DistanceResult) -> float:
        first, second = self._object(self._first[pair]), self._object(self._second[pair])
        # FCL gives -1 for bodies that meet, which does not say how deep they are in each other.
        return max(_MEETING_M, float(fcl.distance(first, second, _WITH_POINTS, result)))

    def _place_m(self, pair: int, result: fcl.DistanceResult, *, touching: bool) -> Array:
        if not touching:
            return np.asarray(np.mean(result.nearest_points, axis=0))
        # The points of bodies that meet are not defined: half way between their middles.
        ends = self._object(self._first[pair]), self._object(self._second[pair])
        return np.asarray(np.mean([end.getTranslation() for end in ends], axis=0))

    def _object(self, index: int) -> fcl.CollisionObject:
        count = len(self._movers)
        return self._movers[index] if index < count else self._standers[index - count]

    def _label(self, index: int) -> str:
        count = len(self._moving)
        return self._moving[index].name if index < count else self._others[index - count].label


def _placed(one: StandingSolid) -> fcl.CollisionObject:
    pose = one.cell_T_shape
    transform = fcl.Transform(pose[:3, :3], pose[:3, 3])
    return fcl.CollisionObject(one.solid.shape.geometry(), transform)


def _reach_m(solid: Solid) -> float:
    return float(np.linalg.norm(solid.link_T_shape[:3, 3])) + solid.shape.radius_m


def _pairs(
    moving: Sequence[Solid], standing: Sequence[StandingSolid], clearances: Clearances
) -> list[tuple[int, int, float]]:
    """Indices of both bodies, over the moving ones and then the standing ones, and what has to stay
    free between them in m."""
    # The base is added, because its bodies stand still and are not among the moving ones.
    links = sorted({solid.link for solid in moving} | {0})
    found = []
    for index, solid in enumerate(moving):
        for number, other in enumerate(moving[index + 1 :], start=index + 1):
            if _may_meet(solid.link, other.link, links):
                # Both margins are those of one arm; what it does to itself needs neither of them.
                found.append((index, number, 0.0))
        for number, one in enumerate(standing, start=len(moving)):
            if one.solid.arm == solid.arm:
                if _may_meet(solid.link, 0, links):
                    found.append((index, number, 0.0))
                continue
            margin_m = solid.margin_m + one.solid.margin_m
            pair = frozenset((solid.name, one.solid.name))
            found.append((index, number, clearances.get(pair, margin_m)))
    return found


def _may_meet(link: int, other: int, links: Sequence[int]) -> bool:
    """Two links of one arm that follow each other are joined, so that their bodies always touch.

    ``links`` are those that have bodies: where one between has none, its neighbours follow.
    """
    return abs(links.index(link) - links.index(other)) > 1
