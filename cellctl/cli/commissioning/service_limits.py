"""`cellctl service-limits`: a drop-in of a unit that leaves what one cell file needs."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.config import load_cell
from cellctl.config.service_limits import (
    drop_in,
    forwarder_drop_in,
    forwarder_limits,
    service_limits,
)
from cellctl.errors.records.fleet import FleetNotNamed


def limits(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    *,
    forwarder: Annotated[
        bool, typer.Option(help="For cellctl-forward.service: only the fleet's server.")
    ] = False,
) -> None:
    """Print a drop-in for cellctl.service: only the peers and devices of this cell are reachable.

    Peers whose address the file does not name are told on standard error.
    """
    cell = load_cell(cell_file)
    if not forwarder:
        found = service_limits(cell)
        typer.echo(drop_in(cell.name, found), nl=False)
    elif cell.fleet is None:
        raise FleetNotNamed(f"{cell_file} has no [fleet]")
    else:
        found = forwarder_limits(cell.fleet)
        typer.echo(forwarder_drop_in(cell.name, found), nl=False)
    for text in found.open_ends:
        typer.echo(f"{text}: add its network to the drop-in by hand", err=True)
