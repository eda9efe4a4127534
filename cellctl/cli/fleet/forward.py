"""`cellctl fleet forward`: the program that delivers the records of a cell."""

import os
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cellctl import log
from cellctl.cli.fleet.store_option import opened_fleet
from cellctl.config.load import load_cell
from cellctl.errors.records.fleet import FleetNotNamed
from cellctl.version import software

if TYPE_CHECKING:
    from cellctl.records.files.delivery_file import DeliveryState

_log = log.get(__name__)


def forward(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    data_dir: Annotated[
        Path | None, typer.Option(help="Run store; default: data_dir of the cell file.")
    ] = None,
    *,
    once: Annotated[bool, typer.Option(help="Deliver what there is, then end.")] = False,
) -> None:
    """Deliver a cell's records until Ctrl-C; runs beside the daemon.

    They go to the database that its cell file names. A server that is away is asked again and
    again, at most a minute apart. With --once a failure is an error.
    """
    from cellctl.fleet.cell_records import CellRecords
    from cellctl.fleet.delivery import Delivery
    from cellctl.fleet.forwarder import Forwarder

    cell = load_cell(cell_file)
    if cell.fleet is None:
        raise FleetNotNamed(f"{cell_file} has no [fleet]")
    log.configure()
    records = CellRecords(data_dir or Path(cell.data_dir))
    with (
        closing(records),
        opened_fleet(cell.fleet.url, cell.fleet.password_file) as fleet,
    ):
        delivery = Delivery(cell.name, records, fleet, software())
        if not once:
            try:
                Forwarder(delivery, tell=_told()).run()
            except KeyboardInterrupt:
                raise typer.Exit(0) from None
        while delivery.deliver():
            pass
        typer.echo(f"all {records.length()} entries of the ledger are delivered")


def _told() -> Callable[["DeliveryState"], None]:
    """Writes into the folder that systemd made for the unit; elsewhere nobody would look for it."""
    from cellctl.records.files.delivery_file import write_state

    folder = os.environ.get("RUNTIME_DIRECTORY", "")

    def tell(state: "DeliveryState") -> None:
        try:
            if folder:
                write_state(Path(folder), state)
        except OSError as error:
            # Records matter more than what is told of them.
            _log.warning("the state of the delivery is not told", folder=folder, reason=str(error))

    return tell
