"""The run store that a command looks into."""

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cellctl.cli.nearest_cell import SERVICE_STORE, nearest_store

if TYPE_CHECKING:
    from cellctl.records.store import RunStore

DataDir = Annotated[
    Path | None,
    typer.Option(
        "--data-dir",
        envvar="CELLCTL_DATA_DIR",
        help=f"Folder of the run store; default: {SERVICE_STORE}, else the newest below runs/.",
    ),
]


def store_folder(data_dir: Path | None) -> Path:
    """The folder that is named, or that of the nearest store, which is told on standard error.

    Raises ``StoreUnavailable`` where there is none.
    """
    if data_dir is None:
        data_dir = nearest_store()
        typer.echo(f"run store {data_dir}", err=True)
    return data_dir


def opened_store(data_dir: Path | None) -> "closing[RunStore]":
    """The store in a folder, or the nearest one.

    Raises ``StoreUnavailable``. A mistyped folder is an error, not a new and empty store.
    """
    # Loaded here: the list of runs does without the database layer.
    from cellctl.records.store import RunStore

    return closing(RunStore(store_folder(data_dir), create=False))
