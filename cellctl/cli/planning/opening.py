"""Opens a cell file with its model; planning is an extra that may not be installed."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cellctl.config import load_cell
from cellctl.config.commissioning import model_issues
from cellctl.config.model_file import model_path, stated_model
from cellctl.errors.config import ConfigInvalid, PlanningNotInstalled

if TYPE_CHECKING:
    from cellctl.planning.scene.cell_scene import CellScene

CellFile = Annotated[Path, typer.Argument(help="The cell's TOML file.")]
ModelFile = Annotated[
    Path | None, typer.Option("--model", help="Its model; else NAME.model.toml beside it.")
]


def open_scene(cell_file: Path, model: Path | None) -> "CellScene":
    """The cell with its model; raises ``PlanningNotInstalled`` and what reading raises."""
    try:
        from cellctl.planning.model.read import read_model
    except ImportError as error:
        raise PlanningNotInstalled(str(error)) from error
    cell, path = load_cell(cell_file), model or model_path(cell_file)
    scene = read_model(cell, path, cell_file.parent)
    found = [str(issue) for issue in model_issues(cell, stated_model(path))]
    if found:
        raise ConfigInvalid(f"{path}: {'; '.join(found)}")
    return scene
