"""The command line: `cellctl --help`."""

import sys

from cellctl.cli.commands import whole_app
from cellctl.cli.root import settings
from cellctl.errors import CellError
from cellctl.terminal.consoles import console_of_lines, print_hanging


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
        print_hanging(console, str(error), 5, "bold red")
        print_hanging(console, f"  cause:  {error.cause}", 10)
        print_hanging(console, f"  remedy: {error.remedy}", 10)
        sys.exit(1)
