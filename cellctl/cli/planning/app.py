"""`cellctl plan`: the group of its commands."""

import typer

from cellctl.cli.planning.check import check
from cellctl.cli.planning.paths import paths
from cellctl.cli.planning.show import show
from cellctl.cli.planning.viewpoints import viewpoints

app = typer.Typer(
    name="plan",
    help="Check and plan the moves and viewpoints of a cell by its model.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.command("show")(show)
app.command("check")(check)
app.command("viewpoints")(viewpoints)
app.command("paths")(paths)
