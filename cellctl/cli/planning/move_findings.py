"""What is wrong with the moves of a cell, for the commands that say it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cellctl.errors.config import NoMovesStated

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene


def move_findings(scene: "CellScene") -> Iterator[str]:
    """Each move that is not good, with number, bodies, place and distance.

    Raises ``NoMovesStated`` where there is none: nothing checked is not the same as everything
    free.
    """
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.planning.ways.check_moves import check_moves

    count = 0
    for checked in check_moves(scene):
        count += 1
        if checked.fault is not None:
            yield str(checked.fault)
    if count == 0:
        raise NoMovesStated(f"cell {scene.cell.name}")
