"""What is wrong with the moves and zones of a cell, for the commands that say it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cellctl.errors.config import NoMovesStated, PlaceUnreachable

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene


class MoveFindings:
    """Goes once through moves and zones, and counts what it has looked at."""

    def __init__(self, scene: "CellScene") -> None:
        self._scene = scene
        self.moves = 0
        self.bad_moves = 0
        self.gaps = 0
        """Zones that let arms meet."""

    def __iter__(self) -> Iterator[str]:
        """Each move that is not good, and each zone that lets arms meet, with number, bodies, place
        and distance."""
        # The libraries of planning may be missing, which opening the scene says.
        from cellctl.planning.ways.check_moves import check_moves
        from cellctl.planning.ways.check_zones import zone_findings

        reached = True
        for checked in check_moves(self._scene):
            self.moves += 1
            if checked.fault is not None:
                self.bad_moves += 1
                reached = reached and not isinstance(checked.fault, PlaceUnreachable)
                yield str(checked.fault)
        if reached:
            for gap in zone_findings(self._scene):
                self.gaps += 1
                yield str(gap)
        elif self._scene.cell.zones:
            # Where an arm cannot come to a place, zones cannot be held against it either.
            yield "zones were not looked at: first an arm has to reach every place of its moves"

    def require_moves(self) -> None:
        """Raise ``NoMovesStated`` where there was none: nothing checked is not the same as
        everything free."""
        if self.moves == 0:
            raise NoMovesStated(f"cell {self._scene.cell.name}")


def move_findings(scene: "CellScene") -> Iterator[str]:
    """All findings; raises ``NoMovesStated`` behind them."""
    findings = MoveFindings(scene)
    yield from findings
    findings.require_moves()
