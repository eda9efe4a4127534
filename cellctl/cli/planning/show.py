"""`cellctl plan show`: pictures of a cell's model."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene

Picture = Annotated[Path, typer.Option("--picture", help="PNG with three views.")]
Glb = Annotated[Path | None, typer.Option("--glb", help="Also a GLB file for a 3-D viewer.")]


def show(
    cell_file: CellFile,
    model: ModelFile = None,
    picture: Picture = Path("cell.png"),
    glb: Glb = None,
) -> None:
    """Draw the model from three sides, arms at their first taught pose, other poses as ghosts."""
    scene = open_scene(cell_file, model)
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.calibration.output_file import write_file
    from cellctl.planning.pictures.glb import cell_glb
    from cellctl.planning.pictures.views import three_views

    write_file(picture, three_views(scene))
    typer.echo(f"written: {picture}")
    if glb is not None:
        write_file(glb, cell_glb(scene))
        typer.echo(f"written: {glb}")
