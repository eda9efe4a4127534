"""`cellctl plan check`: every move that the processes of a cell can command, against its model."""

from typing import TYPE_CHECKING

import typer
from rich.console import Console

from cellctl.cli.consoles import console_of_lines
from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene
from cellctl.errors.config import NoMovesStated, PlaceUnreachable

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene


def check(cell_file: CellFile, model: ModelFile = None) -> None:
    """Check reach, bounds and room of every move, and whether zones keep arms apart.

    Exit code 1 with all that is not good.
    """
    scene = open_scene(cell_file, model)
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.planning.ways.check_moves import check_moves
    from cellctl.planning.ways.check_zones import zone_findings

    console = console_of_lines()
    _say_guesses(console, scene)
    count, bad, reached = 0, 0, True
    for checked in check_moves(scene):
        count += 1
        if checked.fault is not None:
            bad += 1
            reached = reached and not isinstance(checked.fault, PlaceUnreachable)
            console.print(str(checked.fault))
    # Where an arm cannot come to a place, zones cannot be held against it either.
    gaps = list(zone_findings(scene)) if reached else []
    for gap in gaps:
        console.print(str(gap))
    if bad:
        console.print(f"{bad} of {count} moves are not good", style="bold red")
    if bad or gaps:
        raise typer.Exit(1)
    # Nothing checked is not the same as everything free.
    if count == 0:
        raise NoMovesStated(f"{cell_file}")
    console.print(f"{count} moves are free")
    if scene.cell.zones:
        console.print(
            f"zones that keep arms apart wherever they could meet: {len(scene.cell.zones)}"
        )


def _say_guesses(console: Console, scene: "CellScene") -> None:
    guesses = [solid.name for solid in scene.solids if solid.stand_in]
    if guesses:
        text = f"stand-ins, not measured: {', '.join(guesses)}"
        console.print(text, style="yellow")
