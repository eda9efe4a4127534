"""`cellctl calibrate seal`: bring calibration files of an earlier version to the form of today."""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from cellctl.calibration.store.old_form import seal_old_files
from cellctl.cli.nearest_cell import SERVICE_CELL
from cellctl.cli.os_user import terminal_user
from cellctl.config import load_cell
from cellctl.errors.records.store import StoreUnavailable
from cellctl.records.entered.said_by import BY
from cellctl.records.store import RunStore
from cellctl.terminal.consoles import print_warning


def seal(
    *,
    by: Annotated[str, typer.Option(help="Who has compared the dates, for the audit log.")],
    cell: Annotated[Path, typer.Option(help="The cell's TOML file.")] = SERVICE_CELL,
    data_dir: Annotated[
        Path | None, typer.Option(help="Run store; default: data_dir of the cell file.")
    ] = None,
) -> None:
    """Seal dates and serial numbers of files that an earlier version has written, as they are.

    An earlier version protected the record alone. Compare what is printed with your own papers:
    from here on nobody can change it without being noticed.
    """
    config = load_cell(cell)
    folder = cell.parent / config.calibration_dir
    # The files first: they must be sealed even where there is no run store to note it in.
    found = seal_old_files(folder)
    for stored in found:
        typer.echo(
            f"{stored.kind}: made {stored.made:%Y-%m-%d %H:%M}, valid until "
            f"{stored.valid_until:%Y-%m-%d}, serial number {stored.serial_number or 'none'}"
        )
    typer.echo(f"{len(found)} files sealed in {folder}")
    if not found:
        return
    try:
        store = RunStore(data_dir or Path(config.data_dir), create=False)
    except StoreUnavailable as error:
        print_warning(f"not in the audit log: {error}")
        return
    with closing(store):
        detail = {BY: by, "ids": {one.kind: one.id for one in found}}
        store.audit(terminal_user(), "calibrations sealed", detail)
