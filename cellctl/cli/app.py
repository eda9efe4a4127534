"""The command line: `cellctl --help`."""

import sys
from typing import Annotated

import typer
from rich.console import Console

from cellctl.cli import calibrate, check, demo, faults, identify_payload, measure, run, runs
from cellctl.errors import CellError

app = typer.Typer(
    name="cellctl",
    help="Cell controller for vision- and force-guided satellite assembly.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command("check")(check.check)
app.command("run")(run.run)
app.command("demo", context_settings=demo.PASS_THROUGH)(demo.demo)
app.command("measure")(measure.measure)
app.command("identify-payload")(identify_payload.identify_payload)
app.command("faults")(faults.faults)
app.add_typer(calibrate.app, name="calibrate")
app.add_typer(runs.app, name="runs")


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
