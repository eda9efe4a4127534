"""Holds the zones of a cell against its model: whether they keep apart what could meet.

A box that is too small protects nothing: the other arm may then stand just outside of it. Looked at
are all places on the moves that processes state. Where an arm is in a zone, no place of the other
one outside of its box may be within reach of it. Where a process moves an arm beside one that
stands in a zone, on purpose and checked as a move, that zone belongs to the standing arm at its
stated places; all other moves of the moving arm must keep clear of these or be in the zone.

Nothing lies between the places that are looked at: the arm outside is swept without a gap, and the
one inside counts with as much room as its bodies may need on the stretch about each place. A
stretch through the face of a box is taken for whichever side is worse.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, permutations

import numpy as np

from cellctl.cell.zones.zone import Zone, zones_of
from cellctl.config.stated.moves import StatedMove
from cellctl.errors.config import ZoneTooSmall
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import MM, Array
from cellctl.planning.scene.cell_scene import CellScene, Standpoint
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways.check_moves import stated_moves
from cellctl.planning.ways.polyline import joints_at, polyline
from cellctl.planning.ways.sweep import STEP_M, SweptGap, sweep


@dataclass(frozen=True, slots=True, eq=False)
class _Stretch:
    """Less than a degree of a move, anywhere on which an arm may have come to stand."""

    label: str
    joints_rad: Array
    """Both ends, shape (2, 6); equal for a place."""
    zones: frozenset[str]
    """Those in whose boxes its flange is."""
    bodies: frozenset[Solid]
    """Bodies of the arm that are there: a person takes some away for procedures."""
    lever_m: Array
    """Levers of the arm, as ``Surroundings.lever_m``."""

    @property
    def middle_rad(self) -> Array:
        """Joints half way, shape (6,)."""
        return np.asarray(self.joints_rad.mean(axis=0))

    @property
    def reach_m(self) -> float:
        """How far any body may be from where it is half way."""
        start_rad, end_rad = self.joints_rad
        return float(np.abs(end_rad - start_rad) @ self.lever_m) / 2


@dataclass(frozen=True, slots=True, eq=False)
class _Narrow:
    """A stretch of the outer arm on which it comes too near to the inner one."""

    stretch: _Stretch
    swept: SweptGap


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Two arms that share zones, of which the inner one is in one of them."""

    scene: CellScene
    inner: str
    outer: str
    zones: Sequence[Zone]
    """The zones that both of them have."""


def zone_findings(scene: CellScene) -> Iterator[ZoneTooSmall]:
    """Where an arm that is outside of its boxes could meet one that is inside: the narrowest gap.

    Without the bodies that a person takes away for a procedure, on its moves alone. Raises
    ``PlaceUnreachable``.
    """
    zones, moves = zones_of(scene.cell), list(stated_moves(scene))
    for robots in permutations(scene.arms, 2):
        shared = [zone for zone in zones if set(robots) <= zone.shares.keys()]
        if shared:
            yield from _findings(_Pair(scene, *robots, shared), moves)


def _findings(pair: _Pair, moves: Sequence[StatedMove]) -> Iterator[ZoneTooSmall]:
    inside = [one for one in _inside(pair, moves) if one.zones]
    outside: dict[tuple[frozenset[str], frozenset[Solid]], list[_Stretch]] = defaultdict(list)
    others = [one for one in moves if not _is_beside(pair, one)]
    for one in _stretches(pair, pair.outer, others, inside=False):
        outside[one.zones, one.bodies].append(one)
    for (zones, bodies), stretches in outside.items():
        beside: dict[frozenset[Solid], list[_Stretch]] = defaultdict(list)
        for one in inside:
            if not one.zones & zones:
                beside[one.bodies].append(one)
        for other_bodies, other_stretches in beside.items():
            there = replace(pair, scene=replace(pair.scene, solids=(*bodies, *other_bodies)))
            if (found := _narrowest(there, stretches, other_stretches)) is not None:
                yield _finding(pair, found)


def _finding(pair: _Pair, found: _Narrow) -> ZoneTooSmall:
    names = ", ".join(zone.name for zone in pair.zones)
    flange_m = pair.scene.arms[pair.outer].chain.flange_m(found.swept.joints_rad)
    place = ", ".join(f"{value / MM:.0f}" for value in flange_m)
    return ZoneTooSmall(
        f"{names}: {found.swept.gap}; {pair.outer} is {found.stretch.label}, "
        f"flange at ({place}) mm of its base"
    )


def _inside(pair: _Pair, moves: Sequence[StatedMove]) -> Iterator[_Stretch]:
    """Where the inner arm may stand when the outer one begins a move that relies on zones."""
    arm = pair.scene.arms[pair.inner]
    beside = [move for move in moves if _is_beside(pair, move)]
    if not beside:
        yield from _stretches(pair, pair.inner, moves, inside=True)
    bodies = _bodies(pair.scene, pair.inner)
    places = {place.label: place for move in beside for place in move.others[pair.inner]}
    for place in places.values():
        at_rad = joints_at(arm, place)
        zones = _zones_at(pair, pair.inner, at_rad)
        yield _Stretch(place.label, np.array([at_rad, at_rad]), zones, bodies, np.zeros(6))


def _narrowest(
    pair: _Pair, stretches: Sequence[_Stretch], others: Sequence[_Stretch]
) -> _Narrow | None:
    """Where the outer arm comes too near to the inner one; the narrowest that was looked at."""
    suspects = [one.stretch for one in _narrow(pair, stretches, others, wide=True)]
    if not suspects:
        return None
    certain = _narrow(pair, suspects, others, wide=False)
    if certain:
        return min(certain, key=lambda one: one.swept.gap.slack_m)
    # Only what the inner arm may need between its places is too much: where exactly?
    for half in _halves(others):
        if (found := _narrowest(pair, suspects, half)) is not None:
            return found
    return None


def _narrow(
    pair: _Pair, stretches: Sequence[_Stretch], others: Sequence[_Stretch], *, wide: bool
) -> list[_Narrow]:
    """``wide``: with the inner arm anywhere on its stretches; else half way on each of them."""
    standpoints = [
        Standpoint(one.label, tuple(one.middle_rad), one.reach_m if wide else 0.0) for one in others
    ]
    around = pair.scene.around(pair.outer, {pair.inner: standpoints})
    found = [
        _Narrow(one, sweep(around, one.joints_rad))
        for one in stretches
        # A quick look first: an arm with this much room half way is clear at both ends, too.
        if not around.has_room(one.middle_rad, one.reach_m)
    ]
    return [one for one in found if one.swept.gap.slack_m < 0.0]


def _halves(stretches: Sequence[_Stretch]) -> list[Sequence[_Stretch]]:
    """Fewer stretches, or shorter ones; none of one that is too short to matter."""
    if len(stretches) > 1:
        middle = len(stretches) // 2
        return [stretches[:middle], stretches[middle:]]
    (one,) = stretches
    if one.reach_m <= STEP_M:
        return []
    start_rad, end_rad = one.joints_rad
    ends = (start_rad, one.middle_rad), (one.middle_rad, end_rad)
    return [[replace(one, joints_rad=np.array(line))] for line in ends]


def _stretches(
    pair: _Pair, robot: str, moves: Sequence[StatedMove], *, inside: bool
) -> Iterator[_Stretch]:
    """The moves of an arm in small parts, each once.

    ``inside``: a part counts as in a box if one of its ends is in it, else only if both are.
    """
    arm, seen = pair.scene.arms[robot], set[tuple[frozenset[bytes], frozenset[Solid]]]()
    lever_m = pair.scene.around(robot, {}).lever_m
    for move in moves:
        if move.robot != robot:
            continue
        bodies = _bodies(pair.scene.during(move.procedures), robot)
        label = f"between {move.start.label} and {move.end.label}"
        way_rad = np.vstack([joint_path(*line) for line in pairwise(polyline(arm, move))])
        zones = [_zones_at(pair, robot, at_rad) for at_rad in way_rad]
        names = [np.round(at_rad, 6).tobytes() for at_rad in way_rad]
        for index, (start, end) in enumerate(pairwise(names)):
            # A move back passes the same places as the move there.
            key = frozenset((start, end)), bodies
            if start == end or key in seen:
                continue
            seen.add(key)
            here, there = zones[index], zones[index + 1]
            within = here | there if inside else here & there
            yield _Stretch(label, way_rad[index : index + 2], within, bodies, lever_m)


def _bodies(scene: CellScene, robot: str) -> frozenset[Solid]:
    return frozenset(solid for solid in scene.solids if solid.arm == robot)


def _zones_at(pair: _Pair, robot: str, at_rad: Array) -> frozenset[str]:
    flange_m = pair.scene.arms[robot].chain.flange_m(at_rad)
    return frozenset(zone.name for zone in pair.zones if zone.shares[robot].box.holds(flange_m))


def _is_beside(pair: _Pair, move: StatedMove) -> bool:
    """Whether the outer arm moves while the inner one stands in a zone, as the process means it."""
    arm = pair.scene.arms[pair.inner]
    return move.robot == pair.outer and any(
        zone.shares[pair.inner].box.holds(arm.chain.flange_m(joints_at(arm, place)))
        for zone in pair.zones
        for place in move.others.get(pair.inner, ())
    )
