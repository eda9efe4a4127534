"""Every move that this process can command, for planning offline.

Places are those of the drawings: what was found moves them by a few millimetres, which the margins
of the model have to hold. Whoever adds a move to the process adds it here: a test compares both.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

from scipy.spatial.transform import RigidTransform, Slerp

from cellctl.config.cell import CellConfig
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.processes.antenna_module.moves.places import AWAY_M
from cellctl.processes.antenna_module.moves.stated_places import PluggingPlaces
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import (
    HOME,
    INSPECT_PLUG,
    REFERENCE_LOOK,
    SOCKET_LOOK,
    TRAY_LOOK,
)
from cellctl.processes.antenna_module.settings import AntennaSettings


def plugging_moves(cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> Iterator[StatedMove]:
    """Every move of a run, of the way home from wherever it may have ended, and of the procedures.

    Raises ``ArmNotDescribed``.
    """
    # Imported here: it loads what computes, which whoever reads the moves of a run does not need.
    from cellctl.processes.antenna_module.procedures.stated_moves import procedure_moves

    places = PluggingPlaces(cell, recipe, folder)
    settings = cast(AntennaSettings, cell.processes[recipe.process])
    free = [*_to_the_tray(places, settings), *_with_the_module(places), *_to_the_socket(places)]
    free += procedure_moves(places, settings)
    yield from free
    yield from _at_tray_and_socket(places)
    yield from _home_from(places, free)


def _to_the_tray(places: PluggingPlaces, settings: AntennaSettings) -> Iterator[StatedMove]:
    """Steps 10 and 20: past the reference where there is one, and a look at the tray."""
    home, tray_look = places.taught(HOME), places.taught(TRAY_LOOK)
    yield places.joint(home, tray_look)
    if settings.reference is not None:
        yield places.joint(places.taught(REFERENCE_LOOK), tray_look)
    yield places.linear(tray_look, places.above_tray)


def _with_the_module(places: PluggingPlaces) -> Iterator[StatedMove]:
    """Steps 30 to 50: over camera II, back onto the tray with a bad one, and over the socket."""
    above_tray, inspect = places.above_tray, places.taught(INSPECT_PLUG)
    socket_look = places.taught(SOCKET_LOOK)
    yield places.linear(above_tray, places.high_over_tray)
    yield places.joint(places.high_over_tray, inspect)
    yield from places.again(inspect)
    yield places.linear(inspect, places.high_over_tray)
    yield places.linear(places.high_over_tray, above_tray)
    yield places.joint(above_tray, places.taught(TRAY_LOOK))
    yield places.joint(inspect, socket_look)
    yield from places.again(socket_look)
    for away_m in (AWAY_M, -AWAY_M):
        aside = places.aside(socket_look, away_m)
        yield places.linear(socket_look, aside)
        yield places.linear(aside, socket_look)


def _to_the_socket(places: PluggingPlaces) -> Iterator[StatedMove]:
    """Step 70, and within step 90 the look at the released module."""
    socket_look = places.taught(SOCKET_LOOK)
    yield from places.climbing(socket_look, places.over_socket)
    yield from places.climbing(places.released, places.released_look)
    yield from places.again(places.released_look)


def _at_tray_and_socket(places: PluggingPlaces) -> Iterator[StatedMove]:
    """Straight down and up, on the module, the tray and the socket; and out of there after an
    abort."""
    for above, low, clear in (
        (places.above_tray, places.grip, places.above_tray),
        (places.over_socket, places.stand_off, places.clear_of_socket),
        (places.stand_off, places.seat, places.clear_of_socket),
        (places.released, places.seat, places.clear_of_socket),
    ):
        yield places.linear(above, low, approach=True)
        yield places.linear(low, above, approach=True)
        yield places.linear(low, clear, approach=True)
        yield places.joint(clear, places.taught(HOME))


def _home_from(places: PluggingPlaces, free: Sequence[StatedMove]) -> Iterator[StatedMove]:
    """Home from the end of each move, and from its middle, where an abort may have stopped it."""
    home = places.taught(HOME)
    for move in free:
        for place in (move.end, _middle(places, move)):
            yield replace(places.joint(place, home), procedures=move.procedures)


def _middle(places: PluggingPlaces, move: StatedMove) -> StatedPlace:
    label = f"half way to {move.end.label} from {move.start.label}"
    if move.kind is MoveKind.JOINT:
        return StatedPlace(label, (move.start.joints_rad + move.end.joints_rad) / 2.0)
    start, end = (places.arm.flange_at(place) for place in (move.start, move.end))
    between = Slerp([0.0, 1.0], start.rotation.concatenate([start.rotation, end.rotation]))
    middle_m = (start.translation + end.translation) / 2.0
    pose = RigidTransform.from_components(middle_m, between(0.5))
    return StatedPlace(label, move.end.joints_rad, pose)
