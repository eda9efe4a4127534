"""The commands to the running daemon. They load nothing that computes: an Abort must be quick."""

import typer

from cellctl.cli.help.help_groups import OPERATE
from cellctl.cli.operator import alarms, operate, status
from cellctl.cli.root import new_app


def add_operator_commands(app: typer.Typer) -> None:
    """Register them, in the order of the help."""
    for command in (
        status.status,
        operate.clear,
        operate.reset,
        operate.start,
        operate.procedure,
        operate.hold,
        operate.unhold,
        operate.stop,
        operate.abort,
        operate.mode,
    ):
        app.command(command.__name__, rich_help_panel=OPERATE)(command)
    app.add_typer(alarms.app, name="alarms", rich_help_panel=OPERATE)


app = new_app()
add_operator_commands(app)
