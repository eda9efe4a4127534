"""Every move that this process can command, for planning offline.

Whoever adds a move to the process adds it here: a test compares both.
"""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.config.via_points import has_way
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.arms_in_roles import ArmsInRoles, Others
from cellctl.processes.deck_to_frame.moves.lift_off import LIFT_M
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.roles import (
    DECK_MEASURE,
    HOME,
    MEASURING,
    RETRACTED,
)


def deck_moves(cell: CellConfig, recipe: DeckRecipe) -> Iterator[StatedMove]:
    """Every move of a run, of the way back from wherever it may have ended, and of the
    procedures."""
    # Imported here: it loads what computes, which whoever only reads a cell file does not need.
    from cellctl.processes.deck_to_frame.procedures.stated_moves import procedure_moves

    arms = ArmsInRoles(cell, recipe)
    yield from _assembly(arms)
    yield from _way_home(arms)
    yield from _heads(arms)
    yield from procedure_moves(arms)


def _assembly(arms: ArmsInRoles) -> Iterator[StatedMove]:
    """Steps 20 to 50, with both heads over the station."""
    main, recipe, heads = arms.main, arms.recipe, arms.heads_at(MEASURING)
    seat_mm = recipe.deck_thickness_mm
    stand_off_mm = seat_mm + recipe.stand_off_mm
    deck_measure = arms.taught(main, DECK_MEASURE)
    above = arms.frame_at("above the stand-off", stand_off_mm + recipe.station_tolerance_mm)
    stand_off = arms.frame_at("stand-off", stand_off_mm)
    seat = arms.frame_at("seat", seat_mm)
    yield StatedMove(main, MoveKind.JOINT, arms.taught(main, HOME), deck_measure, heads)
    yield StatedMove(main, MoveKind.LINEAR, deck_measure, above, heads)
    yield StatedMove(main, MoveKind.LINEAR, above, stand_off, heads, approach=True)
    yield StatedMove(main, MoveKind.LINEAR, stand_off, seat, heads, approach=True)
    # After a false seat and after a fault in contact.
    yield StatedMove(main, MoveKind.LINEAR, seat, stand_off, heads, approach=True)


def _way_home(arms: ArmsInRoles) -> Iterator[StatedMove]:
    """Reset, and the beginning of everything: the heads may stand where the last run left them."""
    main, heads = arms.main, arms.heads_at(MEASURING, RETRACTED)
    home = arms.taught(main, HOME)
    deck_measure = arms.taught(main, DECK_MEASURE)
    # A stated way home begins there; without one the arm goes straight.
    stated = has_way(arms.cell.robots[main], DECK_MEASURE, HOME)
    first = deck_measure if stated else home
    low_mm = arms.recipe.deck_thickness_mm
    for label, height_mm in (("seat", low_mm), ("stand-off", low_mm + arms.recipe.stand_off_mm)):
        low = arms.frame_at(label, height_mm)
        lifted = arms.frame_at(f"lifted off the {label}", height_mm + LIFT_M / MM)
        yield StatedMove(main, MoveKind.LINEAR, low, lifted, heads, approach=True)
        yield StatedMove(main, MoveKind.JOINT, lifted, first, heads)
    yield StatedMove(main, MoveKind.JOINT, deck_measure, home, heads)


def _heads(arms: ArmsInRoles) -> Iterator[StatedMove]:
    """Both heads over the station and out of the way, at once or alone; the main arm is at home."""
    main = arms.main
    for robot in arms.heads.values():
        others: Others = {main: (arms.taught(main, HOME),)}
        others |= {other: _way(arms, other) for other in arms.heads.values() if other != robot}
        measuring, retracted = arms.taught(robot, MEASURING), arms.taught(robot, RETRACTED)
        yield StatedMove(robot, MoveKind.JOINT, retracted, measuring, others)
        yield StatedMove(robot, MoveKind.JOINT, measuring, retracted, others)


def _way(arms: ArmsInRoles, robot: str) -> tuple[StatedPlace, ...]:
    """Anywhere between both poses of a head's arm: nothing says which of two arms is faster."""
    retracted, measuring = arms.taught(robot, RETRACTED), arms.taught(robot, MEASURING)
    label = f"between {RETRACTED} and {MEASURING}"
    path = joint_path(retracted.joints_rad, measuring.joints_rad)
    between = [StatedPlace(label, joints_rad) for joints_rad in path[1:-1]]
    return (retracted, *between, measuring)
