"""`cellctl clear|reset|start|…`: what an operator may ask of the running daemon."""

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from cellctl.api.local_socket.messages import (
    ModeCommand,
    PlainCommand,
    PlainName,
    ProcedureCommand,
    StartCommand,
    made,
)
from cellctl.api.local_socket.report import StatusReport
from cellctl.cli.nearest_cell import SocketOption
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.errors.local import (
    CommandMissedItsGoal,
    DaemonNotReached,
    DaemonSlow,
    StopNotDelivered,
)
from cellctl.errors.records.store import StoreUnavailable
from cellctl.terminal.consoles import print_warning

_BEGUN = ("EXECUTE", "COMPLETING", "COMPLETED")
_INTERRUPTED = 130
"""Exit code of what Ctrl-C has ended, as shells have it."""
_ENDED = ("COMPLETED", "STOPPED", "ABORTED", "HELD")
Wait = Annotated[
    bool,
    typer.Option("--wait", help="Until it has ended; exit code 0 only if good."),
]


class ModeName(StrEnum):
    """Modes as they are typed."""

    PRODUCTION = "production"
    MAINTENANCE = "maintenance"
    MANUAL = "manual"


def clear(socket: SocketOption = None) -> None:
    """Aborted to Stopped: release the fault, once its cause is removed. Nothing moves."""
    _plain(socket, "clear", ("STOPPED",))


def reset(socket: SocketOption = None) -> None:
    """Stopped or Completed to Idle: robots are released; one inside the station lifts off."""
    _plain(socket, "reset", ("IDLE",))


def hold(socket: SocketOption = None) -> None:
    """Pause at the next safe point."""
    client = DaemonClient(socket)
    client.command(PlainCommand(request="hold"))
    told: set[str] = set()

    def tell_late(report: StatusReport) -> None:
        # Loaded when the command has been given, as in ``_tell``.
        from cellctl.cli.operator.status_screen import NO_SAFE_POINT, hold_is_late

        if hold_is_late(report) and report.step not in told:
            told.add(report.step)
            typer.echo(f"{report.step}: {NO_SAFE_POINT}", err=True)

    with _going_on("the Hold stays asked for: `cellctl unhold` goes on once it is held"):
        # Without a time-out: how long it is to the next safe point is a matter of the step.
        report = client.settled(timeout_s=None, seen=tell_late)
    if report.state == "COMPLETED":
        typer.echo("the run came to its end before a safe point; nothing is held")
    else:
        _arrived(report, ("HELD",))
    _tell(report)


def unhold(socket: SocketOption = None) -> None:
    """Go on after a Hold, beginning with new measurements."""
    _plain(socket, "unhold", _BEGUN)


def stop(socket: SocketOption = None) -> None:
    """End motion and run; obeyed at any time, whoever is in control."""
    _end_motion(socket, "stop", ("STOPPED",))


def abort(socket: SocketOption = None) -> None:
    """Stop and latch all robots at once; obeyed at any time, whoever is in control."""
    _end_motion(socket, "abort", ("ABORTED",))


def start(
    serial: Annotated[str, typer.Option(help="Serial number of the part: A-Z 0-9 . _ -")],
    recipe: Annotated[
        str, typer.Option(help="Name or number; default: the only recipe of the cell.")
    ] = "",
    mate_serial: Annotated[
        str, typer.Option(help="Serial number of the part it is joined to, such as the frame.")
    ] = "",
    order: Annotated[str, typer.Option(help="Order for the record.")] = "",
    *,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="End before the first step in contact.")
    ] = False,
    single_step: Annotated[
        bool, typer.Option("--single-step", help="Hold before each step.")
    ] = False,
    wait: Wait = False,
    socket: SocketOption = None,
) -> None:
    """Assemble a part; only in Production mode."""
    request = made(
        StartCommand,
        serial=serial,
        mate_serial=mate_serial,
        recipe=recipe,
        order=order,
        dry_run=dry_run,
        single_step=single_step,
    )
    _begin(DaemonClient(socket), request, wait=wait)


def procedure(
    number: Annotated[int, typer.Argument(help="Such as 107, see docs/commissioning.md.")],
    serial: Annotated[str, typer.Option(help="For the record; default: PROCEDURE-NUMBER.")] = "",
    *,
    wait: Wait = False,
    socket: SocketOption = None,
) -> None:
    """Calibrate, identify or verify; only in Maintenance mode."""
    request = made(ProcedureCommand, number=number, serial=serial or f"PROCEDURE-{number}")
    _begin(DaemonClient(socket), request, wait=wait)


def mode(
    name: Annotated[ModeName, typer.Argument(help="The mode to change to.")],
    socket: SocketOption = None,
) -> None:
    """Change the mode, in Stopped, Idle or Aborted."""
    client = DaemonClient(socket)
    client.command(ModeCommand(mode=name.value))
    _tell(client.status())


def _plain(socket: SocketOption, name: PlainName, goal: Collection[str]) -> None:
    client = DaemonClient(socket)
    client.command(PlainCommand(request=name))
    with _going_on(f"the cell goes on with the command {name}"):
        report = client.settled()
    _tell(_arrived(report, goal))


def _end_motion(socket: SocketOption, name: PlainName, goal: Collection[str]) -> None:
    """As ``_plain``. Somebody who wants to stop the arms and meets a daemon that does not answer
    must not look for its socket first."""
    try:
        _plain(socket, name, goal)
    except (DaemonNotReached, DaemonSlow) as error:
        raise StopNotDelivered(error.detail) from error


def _begin(client: DaemonClient, request: StartCommand | ProcedureCommand, *, wait: bool) -> None:
    """Give the command and wait; interrupting the wait does not end the run."""
    before = client.status()
    known = {(alarm.number, alarm.since) for alarm in before.alarms}
    goal: tuple[str, ...] = ()
    client.command(request)
    steps = isinstance(request, StartCommand) and request.single_step
    # "Taken" only means that the command is being executed. Starting may still fail, and the
    # operator must see that from the exit code. A run step by step holds before its first step.
    with _going_on("the run goes on"):
        report = _arrived(client.settled(), (*_BEGUN, "HELD") if steps else _BEGUN)
        if wait and not (steps and report.state == "HELD"):
            # Without a time-out, because nobody knows how long a person keeps a run on hold.
            goal = ("COMPLETED", "HELD") if steps else ("COMPLETED",)
            report = client.settled(_ENDED, timeout_s=None, seen=_steps_told())
    if goal and report.last_run == before.last_run:
        # Without a record of its own there is nothing to show but why.
        _arrived(report, goal)
    _tell(report)
    new = [alarm for alarm in report.alarms if (alarm.number, alarm.since) not in known]
    for alarm in new:
        typer.echo(f"alarm {alarm.text}")
    # An alarm that comes again while it is active has the time of its first one.
    if older := [alarm.number for alarm in report.alarms if alarm not in new]:
        if report.last_run != before.last_run:
            for text in _came_again(report, older):
                typer.echo(f"alarm {text}")
        numbers = ", ".join(f"F{number:03d}" for number in older)
        typer.echo(f"not yet acknowledged: {numbers}; see `cellctl alarms`")
    if report.state == "HELD":
        typer.echo(
            "held before the next step: `cellctl unhold` carries it out, `cellctl stop` ends it all"
        )
    elif wait:
        _show_run(report)
        _arrived(report, goal)
        _judge_result(report, dry_run=isinstance(request, StartCommand) and request.dry_run)


@contextmanager
def _going_on(what: str) -> Iterator[None]:
    """Ctrl-C ends the waiting alone: whoever presses it must not believe that the arms stand."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(
            f"only the waiting has ended, {what}; `cellctl stop` ends motion and run, "
            "`cellctl abort` stops and latches all robots at once",
            err=True,
        )
        raise typer.Exit(_INTERRUPTED) from None


def _came_again(report: StatusReport, numbers: Collection[int]) -> Iterator[str]:
    """Alarms of the new run whose numbers were active before: the list of active alarms goes on
    telling of the part that they came with first."""
    from cellctl.cli.records.run_store import opened_store

    if report.last_run is not None:
        with suppress(StoreUnavailable), opened_store(Path(report.data_dir)) as store:
            alarms = store.run(report.last_run.number).alarms
            yield from (alarm.text for alarm in alarms if alarm.number in numbers)


def _show_run(report: StatusReport) -> None:
    """What `cellctl runs show` says of the run, of a bad one as well."""
    # Only a run that is shown needs the run store and what it loads.
    from cellctl.cli.records.runs import show

    if report.last_run is not None:
        try:
            show(report.last_run.number, Path(report.data_dir))
        except StoreUnavailable as error:
            print_warning(f"run {report.last_run.number} cannot be shown: {error}")


def _judge_result(report: StatusReport, *, dry_run: bool) -> None:
    """Raise ``CommandMissedItsGoal`` if the result is not good."""
    if dry_run:
        # It makes no part, so its result is not good, and nothing is wrong with it.
        typer.echo("the dry run has ended before the first step in contact")
    elif report.result != "good":
        raise CommandMissedItsGoal(f"the result is {report.result}")


def _steps_told() -> Callable[[StatusReport], None]:
    """Tells each step as it begins, beside the result: a run lasts minutes."""
    told = ""

    def tell(report: StatusReport) -> None:
        nonlocal told
        if report.step not in ("", told):
            told = report.step
            typer.echo(told, err=True)

    return tell


def _arrived(report: StatusReport, goal: Collection[str]) -> StatusReport:
    if report.state in goal:
        return report
    why = f": {report.faults[0].text}" if report.faults else _whose(report)
    raise CommandMissedItsGoal(f"{report.state}{why}")


def _whose(report: StatusReport) -> str:
    """Whose command led the cell elsewhere; empty where the newest command is another one."""
    # As in ``_came_again``: only who has to be told of it needs the run store.
    from cellctl.cli.records.run_store import opened_store
    from cellctl.packml.command import COMMAND_NAMES
    from cellctl.records.entered.said_by import said_by

    led = {"STOPPED": "stop", "ABORTED": "abort", "HELD": "hold"}.get(report.state)
    with suppress(StoreUnavailable), opened_store(Path(report.data_dir)) as store:
        commands = [one for one in store.audit_log() if one.action in COMMAND_NAMES.values()]
        if commands and commands[-1].action == led:
            last = commands[-1]
            return f" by the command {led} of {said_by(last)}, {last.time:%H:%M:%S} UTC"
    return ""


def _tell(report: StatusReport) -> None:
    # Loaded when the command has been given: an Abort waits for no screen.
    from cellctl.cli.operator.status_screen import pressing

    typer.echo(f"{report.state.lower()}, mode {report.mode.lower()}")
    for text in pressing(report):
        typer.echo(f"an arm may press: {text}")
