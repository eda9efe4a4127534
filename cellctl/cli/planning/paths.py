"""`cellctl plan paths`: free ways between the taught poses of a cell, for a person's review."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene
from cellctl.files.hand_written import read_hand_written
from cellctl.terminal.consoles import console_of_lines

Out = Annotated[
    Path | None, typer.Option("--out", help="Write the cell file with the ways here; else none.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Another one may find another way.")]
Search = Annotated[float, typer.Option("--search-s", min=0.1, help="Longest search for one way.")]


def paths(
    cell_file: CellFile,
    model: ModelFile = None,
    out: Out = None,
    seed: Seed = 1,
    search_s: Search = 30.0,
) -> None:
    """Plan joint ways with via points where straight is not free.

    All moves are checked once more with them; exit code 1 with those that are still not good. What
    is written has to be read by a person and tried at low speed.
    """
    scene = open_scene(cell_file, model)
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.calibration.output_file import write_file
    from cellctl.planning.ways.check_moves import check_moves
    from cellctl.planning.ways.plan_ways import plan_ways, with_ways
    from cellctl.planning.ways.write_ways import with_ways_written

    console = console_of_lines()
    planned = []
    for way in plan_ways(scene, seed=seed, search_s=search_s):
        points = len(way.joints_rad) - 2
        console.print(
            f"{way.robot}: {way.start} to {way.end} and back: {points} points between, "
            f"{way.time_s:.1f} s; narrowest: {way.narrowest}",
        )
        planned.append(way)
    faults = [one.fault for one in check_moves(with_ways(scene, planned)) if one.fault]
    for fault in faults:
        console.print(str(fault))
    if out is not None:
        text = read_hand_written(cell_file)
        write_file(out, with_ways_written(text, planned).encode())
        console.print(f"written: {out}; read it, and try each way at low speed")
    if faults:
        console.print(f"{len(faults)} moves are not good all the same", style="bold red")
        raise typer.Exit(1)
