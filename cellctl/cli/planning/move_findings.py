"""What is wrong with the moves and zones of a cell, for the commands that say it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cellctl.errors.config import NoMovesStated, PlaceUnreachable

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene


def move_findings(scene: "CellScene") -> Iterator[str]:
    """Each move that is not good, and each zone that lets arms meet, with number, bodies, place and
    distance.

    Raises ``NoMovesStated`` where there is none: nothing checked is not the same as everything
    free.
    """
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.planning.ways.check_moves import check_moves
    from cellctl.planning.ways.check_zones import zone_findings

    count, reached = 0, True
    for checked in check_moves(scene):
        count += 1
        if checked.fault is not None:
            reached = reached and not isinstance(checked.fault, PlaceUnreachable)
            yield str(checked.fault)
    # Where an arm cannot come to a place, zones cannot be held against it either.
    if reached:
        yield from (str(fault) for fault in zone_findings(scene))
    if count == 0:
        raise NoMovesStated(f"cell {scene.cell.name}")
