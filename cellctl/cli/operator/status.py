"""`cellctl status`: the cell on one screen."""

import time
from typing import Annotated

import typer
from rich.live import Live

from cellctl.cli.nearest_cell import SocketOption
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.cli.operator.status_screen import last_seen, screen
from cellctl.clock import utc_now
from cellctl.errors.local import DaemonNotReached, DaemonSlow
from cellctl.terminal.consoles import console_of_tables

_PERIOD_S = 1.0


def status(
    *,
    json: Annotated[bool, typer.Option("--json", help="For programs: one JSON object.")] = False,
    watch: Annotated[bool, typer.Option("--watch", help="Follow it until Ctrl-C.")] = False,
    socket: SocketOption = None,
) -> None:
    """State, faults with their remedy, calibrations, links and the last run."""
    # One client for all questions, but a connection for each: a daemon that is restarted meanwhile
    # is found again.
    client = DaemonClient(socket)
    if json:
        # The message as it came: programs get the fields that the API promises, whatever the screen
        # shows.
        typer.echo(client.status().model_dump_json(indent=1))
    elif watch:
        _follow(client)
    else:
        console_of_tables().print(screen(client.status(), utc_now()))


def _follow(client: DaemonClient) -> None:
    report, seen = client.status(), utc_now()
    with Live(screen(report, seen), auto_refresh=False) as live:
        try:
            while True:
                time.sleep(_PERIOD_S)
                try:
                    report, seen = client.status(), utc_now()
                    live.update(screen(report, seen), refresh=True)
                # The operator must not be left with a screen that looks alive. A daemon that is
                # started again is shown again.
                except (DaemonNotReached, DaemonSlow) as away:
                    live.update(last_seen(report, seen, away), refresh=True)
        except KeyboardInterrupt:
            return
