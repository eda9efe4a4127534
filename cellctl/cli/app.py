"""The command line: `cellctl --help`."""

import sys
from collections.abc import Sequence

import typer
from rich.console import Console

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
    """Everything, or what loads in a moment when that is enough."""
    # Loading OpenCV, scipy and matplotlib takes seconds. An Abort does not wait for them, so the
    # commands to the daemon have a command line of their own that loads none of it.
    command = next((word for word in words if not word.startswith("-")), "")
    if command in operator_commands.NAMES:
        return operator_commands.app
    from cellctl.cli.commands import app

    return app
