"""What the administrator of the fleet database does."""

from typing import Annotated

import typer

from cellctl.cli.fleet.store_option import PasswordFile, StoreUrl, opened_fleet


def init(store: StoreUrl = "", password_file: PasswordFile = "") -> None:
    """Make an empty database that of a fleet. Its owner does it, who may create roles."""
    from cellctl.fleet import layout

    with opened_fleet(store, password_file) as fleet:
        layout.create(fleet)
    typer.echo(f"ready. Whoever may read all records: GRANT {layout.READERS} TO their role")


def add(
    cell: Annotated[str, typer.Argument(help="Name of the cell, as in its cell file.")],
    forwarder: Annotated[str, typer.Option(help="Role with which the cell logs in.")],
    store: StoreUrl = "",
    password_file: PasswordFile = "",
) -> None:
    """Take the records of a cell. Its role may add to them and change nothing."""
    from cellctl.fleet import layout

    with opened_fleet(store, password_file) as fleet:
        place = layout.add_cell(fleet, cell, forwarder)
    typer.echo(f"records of {cell!r} are taken from {forwarder}, in the schema {place}")


def migrate(store: StoreUrl = "", password_file: PasswordFile = "") -> None:
    """Bring all tables to this version, before cells are upgraded."""
    from cellctl.fleet import layout

    with opened_fleet(store, password_file) as fleet:
        migrated = layout.migrate(fleet)
    typer.echo(f"migrated: {', '.join(migrated)}" if migrated else "all tables are of this version")
