"""The command line: `cellctl --help`."""

import sys
from typing import Annotated

import typer
from rich.console import Console

from cellctl.cli import (
    alarms,
    calibrate,
    check,
    demo,
    faults,
    identify_payload,
    measure,
    operate,
    run,
    runs,
    status,
)
from cellctl.cli.help_groups import GroupedCommands
from cellctl.errors import CellError

app = typer.Typer(
    name="cellctl",
    cls=GroupedCommands,
    help="Cell controller for vision- and force-guided satellite assembly.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_CELL, _OPERATE, _RECORDS, _OFFLINE = (
    "The cell",
    "Operate the running cell",
    "Records and faults",
    "From files, without a cell",
)
app.command("check", rich_help_panel=_CELL)(check.check)
app.command("run", rich_help_panel=_CELL)(run.run)
app.command("demo", rich_help_panel=_CELL, context_settings=demo.PASS_THROUGH)(demo.demo)
app.command("status", rich_help_panel=_OPERATE)(status.status)
for _command in (
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
    app.command(rich_help_panel=_OPERATE)(_command)
app.add_typer(alarms.app, name="alarms", rich_help_panel=_OPERATE)
app.add_typer(runs.app, name="runs", rich_help_panel=_RECORDS)
app.command("faults", rich_help_panel=_RECORDS)(faults.faults)
app.add_typer(calibrate.app, name="calibrate", rich_help_panel=_OFFLINE)
app.command("measure", rich_help_panel=_OFFLINE)(measure.measure)
app.command("identify-payload", rich_help_panel=_OFFLINE)(identify_payload.identify_payload)


@app.callback()
def _root(
    *, debug: Annotated[bool, typer.Option(help="Show the traceback of a fault.")] = False
) -> None:
    """Numbered faults end with exit code 1 and one clear line; `--debug` shows where."""
    _settings["debug"] = debug


_settings = {"debug": False}


def main() -> None:
    """Entry point: numbered faults become one line on stderr and exit code 1."""
    try:
        app()
    except CellError as error:
        if _settings["debug"]:
            raise
        console = Console(stderr=True, soft_wrap=True, highlight=False)
        console.print(str(error), style="bold red", markup=False)
        console.print(f"  cause:  {error.cause}", markup=False)
        console.print(f"  remedy: {error.remedy}", markup=False)
        sys.exit(1)
