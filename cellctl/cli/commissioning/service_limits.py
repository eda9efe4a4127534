"""`cellctl service-limits`: a drop-in of the unit that leaves what one cell file needs."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.config import load_cell
from cellctl.config.service_limits import drop_in, service_limits


def limits(cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")]) -> None:
    """Print a drop-in for cellctl.service: only the peers and devices of this cell are reachable.

    Devices whose address the file does not name are told on standard error.
    """
    cell = load_cell(cell_file)
    found = service_limits(cell)
    typer.echo(drop_in(cell.name, found), nl=False)
    for text in found.open_ends:
        typer.echo(f"{text}: add its network to the drop-in by hand", err=True)
