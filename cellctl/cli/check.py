"""`cellctl check`: everything that is wrong with a cell file, without touching hardware."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.config import load_cell, problems


def check(cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")]) -> None:
    """Check a cell file; exit code 1 and one line per error when it is not good."""
    found = problems(cell_file)
    console = Console(soft_wrap=True, highlight=False)
    if found:
        table = Table("fault", "key", "value", "allowed", title=f"{cell_file}: {len(found)} errors")
        for problem in found:
            table.add_row(f"F{problem.number}", problem.key, problem.value, problem.allowed)
        console.print(table)
        raise typer.Exit(1)
    cell = load_cell(cell_file)
    console.print(f"{cell_file}: good. Cell '{cell.name}', simulated: {cell.simulated}")
    for key, device in cell.devices().items():
        console.print(f"  {key:20} {device.driver}")
    for recipe in cell.recipes:
        console.print(f"  recipe {recipe.id:<13} {recipe.name}")
