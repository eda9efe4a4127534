"""What quality assurance asks the fleet database."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from cellctl.cli.fleet.store_option import PasswordFile, StoreUrl, opened_fleet
from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_options import (
    AsJson,
    CalibrationId,
    FaultNumber,
    Operator,
    RecipeName,
    Result,
    Serial,
    Since,
    Until,
    printed_head,
    wanted_runs,
)
from cellctl.cli.records.run_tables import run_row, show_record
from cellctl.terminal.consoles import console_of_tables

if TYPE_CHECKING:
    from cellctl.fleet.recall import FleetCell, FoundRun

CLOCKS_APART_S = 5.0
"""From here on a difference of clocks is told, as it disorders the runs of several cells."""
_WHOLE = ("run", "serial", "started (UTC)")
CellName = Annotated[str, typer.Argument(help="Name of the cell, as in its cell file.")]


def cells(
    store: StoreUrl = "", password_file: PasswordFile = "", *, as_json: AsJson = False
) -> None:
    """Which cells deliver, how far each is, whose clock is wrong."""
    from cellctl.fleet import recall

    with opened_fleet(store, password_file) as fleet:
        found = recall.cells(fleet)
    if as_json:
        typer.echo(as_plain([asdict(one) for one in found]))
    elif found:
        console_of_tables().print(_cells(found))
    else:
        typer.echo("no cells; `cellctl fleet add` takes the records of one")


def runs(
    store: StoreUrl = "",
    password_file: PasswordFile = "",
    limit: Annotated[int, typer.Option(help="How many, newest first.", min=1)] = 20,
    *,
    cell: Annotated[str, typer.Option(help="Only of this cell.")] = "",
    serial: Serial = "",
    recipe: RecipeName = "",
    operator: Operator = "",
    result: Result = "",
    fault: FaultNumber = None,
    calibration: CalibrationId = "",
    since: Since = None,
    until: Until = None,
    as_json: AsJson = False,
) -> None:
    """Find runs of all cells by conditions: the parts to recall."""
    from cellctl.fleet import recall

    wanted = wanted_runs(
        serial=serial,
        recipe=recipe,
        operator=operator,
        result=result,
        fault=fault,
        calibration=calibration,
        since=since,
        until=until,
    )
    with opened_fleet(store, password_file) as fleet:
        found = recall.runs(fleet, wanted, limit, cell or None)
    if as_json:
        rows = [{"cell": one.cell} | one.run.for_programs() for one in found]
        typer.echo(as_plain(rows))
    elif found:
        console_of_tables().print(_runs(found))
    else:
        typer.echo("no runs")


def show(
    cell: CellName,
    run: Annotated[int, typer.Argument(help="Number of the run at that cell.", min=1)],
    store: StoreUrl = "",
    password_file: PasswordFile = "",
    *,
    as_json: AsJson = False,
) -> None:
    """One run of a cell in figures; its files stay at the cell."""
    from cellctl.fleet import recall

    with opened_fleet(store, password_file) as fleet:
        record, audit = recall.run(fleet, cell, run)
    show_record(record, audit, as_json=as_json)


def verify(
    store: StoreUrl = "",
    password_file: PasswordFile = "",
    *,
    cell: Annotated[str, typer.Option(help="Only this cell.")] = "",
    head: Annotated[str, typer.Option(help="LENGTH:HASH, as printed on a report of --cell.")] = "",
) -> None:
    """Check that records are as sealed; exit code 1 if not.

    Somebody who computes a whole chain anew is found out only by a head that he does not have: with
    --cell and --head that of a report, or what `cellctl runs verify` prints at the cell.
    """
    if head and not cell:
        raise typer.BadParameter("a head is of one cell: give --cell", param_hint="--head")
    from cellctl.fleet import recall

    bad = False
    with opened_fleet(store, password_file) as fleet:
        for one in recall.cells(fleet, cell or None):
            for problem in recall.problems(fleet, one.name, printed_head(head)):
                bad = True
                typer.echo(f"{one.name}: {problem}")
            behind = f", {one.still_to_come} still to come" if one.still_to_come else ""
            typer.echo(f"{one.name}: ledger head {one.head}{behind}", err=True)
    if bad:
        raise typer.Exit(1)
    typer.echo("all records are as they were sealed")


def _cells(found: Sequence["FleetCell"]) -> Table:
    table = Table(box=None, padding=(0, 1, 0, 0))
    for name in ("cell", "entries", "to come", "last delivery (UTC)", "clock", "software"):
        table.add_column(name, overflow="fold")
    for one in found:
        received = f"{one.received:%Y-%m-%d %H:%M:%S}" if one.received else "never"
        ahead_s = one.clock_ahead_s or 0.0
        clock = Text("" if abs(ahead_s) < CLOCKS_APART_S else f"{ahead_s:+.0f} s", style="red")
        counts = str(one.head.length), str(one.still_to_come)
        table.add_row(one.name, *counts, received, clock, one.software)
    return table


def _runs(found: Sequence["FoundRun"]) -> Table:
    table = Table(box=None, padding=(0, 1, 0, 0))
    for name in ("cell", "run", "serial", "recipe", "mode", "started (UTC)", "duration", "result"):
        # Folded and not cut: names are what the next command is given. A serial number that is
        # broken is read as another one.
        table.add_column(name, no_wrap=name in _WHOLE, overflow="fold")
    for one in found:
        row = run_row(one.run.head, spoilt=one.run.spoilt, wide=False)
        table.add_row(one.cell, *row)
    return table
