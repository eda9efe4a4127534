"""The command line: `cellctl --help`."""

import sys

from rich.console import Console

from cellctl.cli.commands import whole_app
from cellctl.cli.root import settings
from cellctl.errors import CellError


def main() -> None:
    """Entry point: numbered faults become one line on stderr and exit code 1."""
    try:
        whole_app()()
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
