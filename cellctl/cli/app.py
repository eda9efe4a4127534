"""The command line: `cellctl --help`."""

import sys
from collections.abc import Sequence

import typer
from rich.console import Console

from cellctl.cli.commands import app_with, whole_app
from cellctl.cli.operator import commands as operator_commands
from cellctl.cli.root import settings
from cellctl.errors import CellError


def main() -> None:
    """Entry point: numbered faults become one line on stderr and exit code 1."""
    try:
        _app_for(sys.argv[1:])()
    except CellError as error:
        # An operator needs cause and remedy; the traceback is for whoever looks for a bug, and only
        # on request.
        if settings["debug"]:
            raise
        console = Console(stderr=True, soft_wrap=True, highlight=False)
        console.print(str(error), style="bold red", markup=False)
        console.print(f"  cause:  {error.cause}", markup=False)
        console.print(f"  remedy: {error.remedy}", markup=False)
        sys.exit(1)


def _app_for(words: Sequence[str]) -> typer.Typer:
    """The command line with the command that is asked for; with all of them for the help."""
    # An Abort does not wait until OpenCV, scipy and matplotlib are loaded, so the commands to the
    # daemon have a command line of their own.
    name = next((word for word in words if not word.startswith("-")), "")
    if name in operator_commands.NAMES:
        return operator_commands.app
    return app_with(name) or whole_app()
