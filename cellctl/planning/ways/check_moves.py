"""Checks every move that the processes of a cell can command against its model."""

from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cellctl.config.process_definition import process_definition
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.errors.config import (
    BodiesCollide,
    ClearanceTooSmall,
    ConfigInvalid,
    PlaceUnreachable,
    PlanningError,
)
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import Array
from cellctl.planning.scene.cell_scene import CellScene, Standpoint
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.ways.polyline import joints_at, polyline
from cellctl.planning.ways.sweep import SweptGap, sweep


@dataclass(frozen=True, slots=True, eq=False)
class CheckedMove:
    """What the check of one move says."""

    move: StatedMove
    narrowest: SweptGap | None
    """The narrowest gap on the way; None where the arm cannot make the move at all."""
    fault: PlanningError | None
    """Why the move is not good; None for one that is."""


def stated_moves(scene: CellScene) -> Iterator[StatedMove]:
    """The moves of all recipes; one that several recipes share is stated once."""
    seen: set[Hashable] = set()
    for recipe in scene.cell.recipes:
        definition = process_definition(recipe.process)
        for move in definition.moves(scene.cell, recipe, scene.folder):
            # Recipes of one station share most of their moves.
            if (key := _key(move)) not in seen:
                seen.add(key)
                yield move


def check_moves(scene: CellScene) -> Iterator[CheckedMove]:
    """Every stated move of an arm that the model has.

    Raises ``ConfigInvalid`` where the model names a procedure that moves nothing.
    """
    moves = list(stated_moves(scene))
    # Where no process states a move, that is what the caller has to say.
    if moves:
        _require_known(scene, frozenset[int]().union(*(move.procedures for move in moves)))
    for move in moves:
        yield check_move(scene, move)


def _require_known(scene: CellScene, procedures: frozenset[int]) -> None:
    """A wrong number would leave its body in the way, or hide one that stands there."""
    for solid in scene.solids:
        unknown = sorted(solid.absent_in - procedures)
        if unknown:
            raise ConfigInvalid(
                f"{solid.name}: absent_in names {unknown}; procedures with moves that no "
                f"run makes: {sorted(procedures)}"
            )


def check_move(scene: CellScene, move: StatedMove) -> CheckedMove:
    """One move: reach, bounds, and room on the whole way."""
    arm = scene.arms.get(move.robot)
    if arm is None:
        fault = PlaceUnreachable(f"{move.name}: the model has no robot {move.robot}")
        return CheckedMove(move, None, fault)
    try:
        way_rad = polyline(arm, move)
        around = surroundings_of(scene, move)
        require_in_bounds(around, move, way_rad)
    except PlaceUnreachable as fault:
        return CheckedMove(move, None, fault)
    found = sweep(around, way_rad)
    return CheckedMove(move, found, gap_fault(move.name, found))


def gap_fault(name: str, found: SweptGap) -> PlanningError | None:
    """The fault of a gap that is too narrow; None for one that is wide enough."""
    if found.gap.slack_m >= 0.0:
        return None
    joints_deg = np.round(np.degrees(found.joints_rad), 1).tolist()
    kind = BodiesCollide if found.gap.distance_m <= 0.0 else ClearanceTooSmall
    return kind(f"{name}: {found.gap}, with the arm at {joints_deg} deg")


def surroundings_of(scene: CellScene, move: StatedMove) -> Surroundings:
    """The arm of a move with the others at all places at which they may be meanwhile."""
    others = {
        robot: [
            Standpoint(place.label, tuple(joints_at(scene.arms[robot], place))) for place in places
        ]
        for robot, places in move.others.items()
        if robot in scene.arms
    }
    there = scene.during(move.procedures)
    return there.around(move.robot, others, approach=move.approach)


def require_in_bounds(around: Surroundings, move: StatedMove, way_rad: Array) -> None:
    """Raise ``PlaceUnreachable`` where driver or zones would refuse a joint move on its way."""
    # The bounds of straight moves are wider or narrower ones, which the driver holds against them.
    if move.kind is not MoveKind.JOINT:
        return
    for start_rad, end_rad in pairwise(way_rad):
        for at_rad in joint_path(start_rad, end_rad):
            refusal = around.refusal(at_rad)
            if refusal is not None:
                raise PlaceUnreachable(f"{move.name}: {refusal}")


def _key(move: StatedMove) -> Hashable:
    """Equal for moves of which one check says all."""
    # With the other arms: one move may be free past where they stand in one recipe, and not past
    # where they stand in another.
    others = frozenset(
        (robot, frozenset(_numbers(place) for place in places))
        for robot, places in move.others.items()
    )
    ends = _numbers(move.start), _numbers(move.end)
    return move.name, move.approach, *ends, others, move.procedures


def _numbers(place: StatedPlace) -> bytes:
    pose = place.base_T_flange
    matrix = np.zeros((4, 4)) if pose is None else pose.as_matrix()
    return np.round(np.concatenate([place.joints_rad, matrix.ravel()]), 6).tobytes()
