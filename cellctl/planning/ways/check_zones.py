"""Holds the zones of a cell against its model: whether they keep apart what could meet.

A box that is too small protects nothing: the other arm may then stand just outside of it. Looked at
are all places on the moves that processes state. Where an arm is in a zone, no place of the other
one outside of its box may be within reach of it. Where a process moves an arm beside one that
stands in a zone, on purpose and checked as a move, that zone belongs to the standing arm at its
stated places; all other moves of the moving arm must keep clear of these or be in the zone.
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
from cellctl.planning.scene.nearest import NarrowestGap
from cellctl.planning.scene.solid import Solid
from cellctl.planning.ways.check_moves import stated_moves
from cellctl.planning.ways.polyline import joints_at, polyline

_SAME_DEG = 2.0
"""Places whose joints are this near to each other are one."""


@dataclass(frozen=True, slots=True, eq=False)
class _Stop:
    """A place at which an arm may have come to stand."""

    label: str
    joints_rad: Array
    zones: frozenset[str]
    """Those in whose boxes its flange is."""
    bodies: frozenset[Solid]
    """Of the arm there: a person takes some away for procedures."""


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Two arms that share zones, of which the inner one is in one of them."""

    scene: CellScene
    inner: str
    outer: str
    zones: Sequence[Zone]
    """Those that both of them have."""


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
    inside = [stop for stop in _inside(pair, moves) if stop.zones]
    outside: dict[tuple[frozenset[str], frozenset[Solid]], list[_Stop]] = defaultdict(list)
    for stop in _stops(pair, pair.outer, [one for one in moves if not _is_beside(pair, one)]):
        outside[stop.zones, stop.bodies].append(stop)
    for (zones, bodies), stops in outside.items():
        others: dict[frozenset[Solid], list[_Stop]] = defaultdict(list)
        for stop in inside:
            if not stop.zones & zones:
                others[stop.bodies].append(stop)
        for other_bodies, other_stops in others.items():
            there = replace(pair, scene=replace(pair.scene, solids=(*bodies, *other_bodies)))
            if (found := _narrowest(there, stops, other_stops)) is not None:
                stop, gap = found
                names = ", ".join(zone.name for zone in pair.zones)
                yield ZoneTooSmall(f"{names}: {gap}; {pair.outer} is {stop.label}")


def _inside(pair: _Pair, moves: Sequence[StatedMove]) -> Iterator[_Stop]:
    """Where the inner arm may stand when the outer one begins a move that relies on zones."""
    arm = pair.scene.arms[pair.inner]
    beside = [move for move in moves if _is_beside(pair, move)]
    if not beside:
        yield from _stops(pair, pair.inner, moves)
    places = {place.label: place for move in beside for place in move.others[pair.inner]}
    for place in places.values():
        bodies = _bodies(pair.scene, pair.inner)
        yield _stop(pair, pair.inner, place.label, joints_at(arm, place), bodies)


def _narrowest(
    pair: _Pair, stops: Sequence[_Stop], others: Sequence[_Stop]
) -> tuple[_Stop, NarrowestGap] | None:
    """The narrowest gap between both arms that is too narrow, and where the outer one stands."""
    standpoints = [Standpoint(stop.label, tuple(stop.joints_rad)) for stop in others]
    around = pair.scene.around(pair.outer, {pair.inner: standpoints})
    narrow = [
        (stop, around.narrowest(stop.joints_rad))
        for stop in stops
        if not around.has_room(stop.joints_rad, 0.0)
    ]
    return min(narrow, key=lambda found: found[1].slack_m, default=None)


def _stops(pair: _Pair, robot: str, moves: Sequence[StatedMove]) -> Iterator[_Stop]:
    """Places on the moves of an arm, each once."""
    arm, seen = pair.scene.arms[robot], set[tuple[bytes, frozenset[Solid]]]()
    for move in moves:
        if move.robot != robot:
            continue
        way_rad = polyline(arm, move)
        bodies = _bodies(pair.scene.during(move.procedures), robot)
        for at_rad in np.vstack([joint_path(*line) for line in pairwise(way_rad)]):
            # Moves there and back, and those of one point, pass the same places.
            key = np.round(np.degrees(at_rad) / _SAME_DEG).tobytes(), bodies
            if key not in seen:
                seen.add(key)
                label = f"between {move.start.label} and {move.end.label}"
                yield _stop(pair, robot, label, at_rad, bodies)


def _bodies(scene: CellScene, robot: str) -> frozenset[Solid]:
    return frozenset(solid for solid in scene.solids if solid.arm == robot)


def _stop(pair: _Pair, robot: str, label: str, at_rad: Array, bodies: frozenset[Solid]) -> _Stop:
    flange_m = pair.scene.arms[robot].chain.flange_m(at_rad)
    zones = frozenset(zone.name for zone in pair.zones if zone.shares[robot].box.holds(flange_m))
    place = ", ".join(f"{value / MM:.0f}" for value in flange_m)
    return _Stop(f"{label}, flange at ({place}) mm of its base", at_rad, zones, bodies)


def _is_beside(pair: _Pair, move: StatedMove) -> bool:
    """Whether the outer arm moves while the inner one stands in a zone, as the process means it."""
    arm = pair.scene.arms[pair.inner]
    return move.robot == pair.outer and any(
        zone.shares[pair.inner].box.holds(arm.chain.flange_m(joints_at(arm, place)))
        for zone in pair.zones
        for place in move.others.get(pair.inner, ())
    )
