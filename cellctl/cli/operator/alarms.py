"""`cellctl alarms`: the alarms that nobody has acknowledged yet."""

from typing import Annotated

import typer

from cellctl.api.local_socket.messages import AcknowledgeCommand, made
from cellctl.cli.nearest_cell import SocketOption
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.cli.operator.status_screen import with_time
from cellctl.cli.records.plain_json import as_plain
from cellctl.errors.base import fault_number
from cellctl.terminal.consoles import console_of_lines, print_hanging

app = typer.Typer(help="List and acknowledge the alarms of the running daemon.")


@app.callback(invoke_without_command=True)
def list_alarms(
    context: typer.Context,
    socket: SocketOption = None,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """List the active alarms with what to do; `acknowledge` takes one off the list."""
    if context.invoked_subcommand is not None:
        return
    alarms = DaemonClient(socket).status().alarms
    if as_json:
        typer.echo(as_plain([alarm.model_dump() for alarm in alarms]))
        return
    console = console_of_lines()
    for alarm in alarms:
        print_hanging(console, with_time(alarm), 5, "yellow")
        print_hanging(console, f"  cause:  {alarm.cause}", 10)
        print_hanging(console, f"  remedy: {alarm.remedy}", 10)
    if not alarms:
        console.print("no alarms")


@app.command()
def acknowledge(
    number: Annotated[
        int,
        typer.Argument(
            parser=fault_number, help="Number of the fault, such as F529 or 529.", metavar="NUMBER"
        ),
    ],
    socket: SocketOption = None,
) -> None:
    """Acknowledge every alarm with this number; it releases no fault and moves nothing."""
    DaemonClient(socket).command(made(AcknowledgeCommand, number=number))
    typer.echo(f"F{number:03d} acknowledged")
