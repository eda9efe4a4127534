"""The command line: `cellctl --help`."""

import sys

from cellctl.cli.commands import whole_app
from cellctl.cli.consoles import console_of_lines
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
        console = console_of_lines(stderr=True)
        console.print(str(error), style="bold red")
        console.print(f"  cause:  {error.cause}")
        console.print(f"  remedy: {error.remedy}")
        sys.exit(1)
