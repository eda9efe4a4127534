"""Plans the ways between taught poses that the moves of a cell's processes need."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cellctl.config.devices import WayConfig
from cellctl.config.stated.moves import MoveKind, StatedMove
from cellctl.errors.config import NoFreeWay, PlaceUnreachable
from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.nearest import NarrowestGap
from cellctl.planning.ways.check_moves import (
    gap_fault,
    stated_moves,
    surroundings_of,
)
from cellctl.planning.ways.polyline import joints_at
from cellctl.planning.ways.search import free_way
from cellctl.planning.ways.sweep import SweptGap, sweep
from cellctl.planning.ways.travel import travel_s


@dataclass(frozen=True, slots=True, eq=False)
class PlannedWay:
    """A way between two taught poses of one robot, in both directions."""

    robot: str
    start: str
    end: str
    joints_rad: Array
    """Shape (n, 6), both ends included; n is 2 where straight is free."""
    narrowest: NarrowestGap
    time_s: float

    def written(self) -> tuple[WayConfig, ...]:
        """The way in the form of the cell file; nothing for a straight one."""
        via = [tuple(np.round(np.degrees(at), 4).tolist()) for at in self.joints_rad[1:-1]]
        if not via:
            return ()
        forth = {"start": self.start, "end": self.end, "via_deg": via}
        back = {"start": self.end, "end": self.start, "via_deg": via[::-1]}
        return WayConfig.model_validate(forth), WayConfig.model_validate(back)


def plan_ways(scene: CellScene, *, seed: int, search_s: float) -> Iterator[PlannedWay]:
    """One for each pair of taught poses between which a process moves by joints.

    With all other arms at every place that any of these moves allows. Raises ``PlaceUnreachable``,
    ``BodiesCollide`` or ``ClearanceTooSmall`` where an end is not free, ``NoFreeWay``.
    """
    for pair in _pairs(scene):
        move = _united(pair)
        arm = scene.arms[move.robot]
        around = surroundings_of(scene, move)
        ends = [joints_at(arm, place) for place in (move.start, move.end)]
        for place, at_rad in zip((move.start, move.end), ends, strict=True):
            found = SweptGap(around.narrowest(at_rad), at_rad)
            if fault := gap_fault(f"{move.robot}: {place.label}", found):
                raise fault
            # Else the search would look for a way to a place that no way may lead to.
            if refusal := around.refusal(at_rad):
                raise PlaceUnreachable(f"{move.robot}: {place.label}: {refusal}")
        try:
            way_rad = free_way(around, ends[0], ends[1], seed=seed, search_s=search_s)
        except NoFreeWay as fault:
            raise NoFreeWay(f"{move.name}: {fault.detail}") from fault
        narrowest = sweep(around, way_rad).gap
        names = move.robot, move.start.label, move.end.label
        yield PlannedWay(*names, way_rad, narrowest, travel_s(arm, way_rad))


def with_ways(scene: CellScene, ways: Sequence[PlannedWay]) -> CellScene:
    """The scene as it is when the cell file has these ways in place of those that it had."""
    arms: dict[str, PlannedArm] = {}
    for name, arm in scene.arms.items():
        written = tuple(one for way in ways if way.robot == name for one in way.written())
        arms[name] = replace(arm, config=arm.config.model_copy(update={"ways": written}))
    return scene.with_arms(arms)


def _pairs(scene: CellScene) -> list[list[StatedMove]]:
    """Joint moves between taught poses, those of both directions together."""
    pairs: dict[tuple[str, frozenset[str]], list[StatedMove]] = {}
    for move in stated_moves(scene):
        taught = scene.cell.robots[move.robot].poses_deg
        ends = move.start.label, move.end.label
        if move.kind is MoveKind.JOINT and all(end in taught for end in ends):
            pairs.setdefault((move.robot, frozenset(ends)), []).append(move)
    return list(pairs.values())


def _united(moves: Sequence[StatedMove]) -> StatedMove:
    """The first move with the other arms wherever any of the moves allows.

    One way serves both directions, so that it has to be free in each of them.
    """
    by_procedures = [move.procedures for move in moves]
    # Beside a move of a run no procedure is alone with it.
    alone = frozenset[int]().union(*by_procedures) if all(by_procedures) else frozenset[int]()
    others = {
        robot: tuple(place for move in moves for place in move.others.get(robot, ()))
        for robot in {name for move in moves for name in move.others}
    }
    return replace(moves[0], others=others, procedures=alone)
