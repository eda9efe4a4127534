"""The fleet database that a command works with."""

from contextlib import closing
from typing import TYPE_CHECKING, Annotated

import typer

from cellctl.errors.records.fleet import FleetNotNamed

if TYPE_CHECKING:
    from cellctl.fleet.database import FleetDatabase

StoreUrl = Annotated[
    str,
    typer.Option(
        "--store",
        envvar="CELLCTL_FLEET",
        help="postgresql://USER@HOST:PORT/DATABASE of all cells, without a password.",
    ),
]
PasswordFile = Annotated[
    str,
    typer.Option(
        "--password-file",
        envvar="CELLCTL_FLEET_PASSWORD_FILE",
        help="Its first line is the password; else CELLCTL_FLEET_PASSWORD, else as psql finds it.",
    ),
]


def opened_fleet(store: str, password_file: str) -> "closing[FleetDatabase]":
    """The database; raises ``FleetNotNamed``, ``FleetNotInstalled``."""
    if not store:
        raise FleetNotNamed("neither --store nor CELLCTL_FLEET is given")
    # Loaded here: `cellctl fleet --help` does without the database layer.
    from cellctl.fleet.address import address
    from cellctl.fleet.database import FleetDatabase

    return closing(FleetDatabase(address(store, password_file)))
