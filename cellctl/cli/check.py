"""`cellctl check`: everything that is wrong with a cell file, without touching hardware."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cellctl.atomic_files import may_write
from cellctl.config import load_cell, problems
from cellctl.processes.deck_to_frame.mating.plan_check import plan_problems


def check(cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")]) -> None:
    """Check a cell file; exit code 1, with every error and what is allowed, when it is not good."""
    found = problems(cell_file) or list(plan_problems(load_cell(cell_file)))
    console = Console(soft_wrap=True, highlight=False)
    if found:
        errors = "1 error" if len(found) == 1 else f"{len(found)} errors"
        console.print(f"{cell_file}: {errors}", style="bold red", markup=False)
        for problem in found:
            console.print(f"F{problem.number} {problem.key} = {problem.value}", markup=False)
            console.print(f"     {problem.allowed}", markup=False)
        raise typer.Exit(1)
    cell = load_cell(cell_file)
    console.print(f"{cell_file}: good. Cell '{cell.name}', simulated: {cell.simulated}")
    for key, device in cell.devices().items():
        console.print(f"  {key:20} {device.driver}")
    for recipe in cell.recipes:
        console.print(f"  recipe {recipe.id:<13} {recipe.name}")
    calibrations = cell_file.parent / cell.calibration_dir
    if not may_write(calibrations):
        console.print(
            f"  calibration_dir {calibrations}: this user may not write it, the daemon's must",
            style="yellow",
            markup=False,
        )
