"""The run store that a command looks into."""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.nearest_cell import SERVICE_STORE, nearest_store
from cellctl.records.store import RunStore

DataDir = Annotated[
    Path | None,
    typer.Option(
        "--data-dir",
        envvar="CELLCTL_DATA_DIR",
        help=f"Folder of the run store; default: {SERVICE_STORE}, else the newest below runs/.",
    ),
]


def opened_store(data_dir: Path | None) -> closing[RunStore]:
    """The store in a folder, or the nearest one, whose folder is told on standard error.

    Raises ``StoreUnavailable``. A mistyped folder is an error, not a new and empty store.
    """
    if data_dir is None:
        data_dir = nearest_store()
        typer.echo(f"run store {data_dir}", err=True)
    return closing(RunStore(data_dir, create=False))
