"""`cellctl plan show`: pictures of a cell's model."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene
from cellctl.errors.config import HeadNotDescribed, PlaceUnreachable
from cellctl.terminal.consoles import print_warning

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
    from cellctl.planning.pictures.frusta import Frustum, frusta
    from cellctl.planning.pictures.glb import cell_glb
    from cellctl.planning.pictures.paths import FlangePath, flange_paths
    from cellctl.planning.pictures.views import three_views

    views: tuple[Frustum, ...] = ()
    paths: tuple[FlangePath, ...] = ()
    try:
        views = tuple(frusta(scene))
    except HeadNotDescribed as fault:
        print_warning(f"what the heads see is not drawn: {fault}")
    try:
        paths = tuple(flange_paths(scene))
    except PlaceUnreachable as fault:
        print_warning(f"the ways of the flanges are not drawn: {fault}")
    write_file(picture, three_views(scene, views, paths))
    typer.echo(f"written: {picture}")
    if glb is not None:
        write_file(glb, cell_glb(scene, views, paths))
        typer.echo(f"written: {glb}")
