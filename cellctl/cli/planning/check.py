"""`cellctl plan check`: every move that the processes of a cell can command, against its model."""

from typing import TYPE_CHECKING

import typer
from rich.console import Console

from cellctl.cli.planning.move_findings import MoveFindings
from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene
from cellctl.terminal.consoles import console_of_lines

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene


def check(cell_file: CellFile, model: ModelFile = None) -> None:
    """Check reach, bounds and room of every move, and whether zones keep arms apart.

    Exit code 1 with all that is not good.
    """
    scene = open_scene(cell_file, model)
    console = console_of_lines()
    _say_guesses(console, scene)
    findings = MoveFindings(scene)
    for finding in findings:
        console.print(finding)
    if findings.bad_moves:
        console.print(
            f"{findings.bad_moves} of {findings.moves} moves are not good", style="bold red"
        )
    if findings.bad_moves or findings.gaps:
        raise typer.Exit(1)
    findings.require_moves()
    console.print(f"{findings.moves} moves are free")
    if scene.cell.zones:
        console.print(
            f"zones that keep arms apart wherever they could meet: {len(scene.cell.zones)}"
        )


def _say_guesses(console: Console, scene: "CellScene") -> None:
    guesses = [solid.name for solid in scene.solids if solid.stand_in]
    if guesses:
        text = f"stand-ins, not measured: {', '.join(guesses)}"
        console.print(text, style="yellow")
