"""`cellctl runs`: look into the run store; enter what a person measured."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.os_user import terminal_user
from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_mcap import Images, write_mcap
from cellctl.cli.records.run_note import note
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
from cellctl.cli.records.run_report import report
from cellctl.cli.records.run_store import DataDir, opened_store, store_folder
from cellctl.cli.records.run_tables import gauge_line, run_table, show_record
from cellctl.cli.records.trend import trend
from cellctl.records.entered.said_by import BY, ENTERED, GAUGE, gauge_entries
from cellctl.records.report.acceptance.runs_before import runs_before
from cellctl.records.run_list import listed_runs
from cellctl.terminal.consoles import console_of_tables

app = typer.Typer(help="Look into the run store.", no_args_is_help=True)

Run = Annotated[int, typer.Argument(help="Number of the run.", min=1)]


app.command("trend")(trend)


@app.command("list")
def list_runs(
    data_dir: DataDir = None,
    limit: Annotated[int, typer.Option(help="How many, newest first.", min=1)] = 20,
    *,
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
    """The newest runs; of all that fulfil every condition that is given."""
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
    found = listed_runs(store_folder(data_dir), limit, wanted)
    if as_json:
        typer.echo(as_plain([one.for_programs() for one in found]))
        return
    if not found:
        typer.echo("no runs")
        return
    spoilt = {one.head.number for one in found if one.spoilt}
    console = console_of_tables()
    console.print(run_table([one.head for one in found], console, spoilt))


@app.command()
def show(run: Run, data_dir: DataDir = None, *, as_json: AsJson = False) -> None:
    """One run in figures."""
    with opened_store(data_dir) as store:
        record = store.run(run)
        audit, before = store.audit_log(), runs_before(store, record.head)
    show_record(record, audit, before, as_json=as_json)


@app.command()
def export(
    run: Run,
    *,
    out: Annotated[
        Path | None, typer.Option(help="Folder or file; default: run-NUMBER, run-NUMBER.mcap.")
    ] = None,
    data_dir: DataDir = None,
    single_file: Annotated[
        bool, typer.Option("--single-file", help="Pictures inside the report.")
    ] = False,
    mcap: Annotated[
        bool, typer.Option("--mcap", help="As one MCAP file for Foxglove, in place of a folder.")
    ] = False,
    images: Annotated[Images, typer.Option(help="Raw images in the MCAP file.")] = Images.LOSSLESS,
) -> None:
    """Write record, report, pictures and recordings of a run into a folder, or into one file."""
    if mcap:
        with opened_store(data_dir) as store:
            write_mcap(store, run, out, images)
        return
    # Loaded here: the processes' pages bring scipy and matplotlib, which `runs list` does without.
    from cellctl.cli.records.process_pages import pages_of
    from cellctl.records.report.export import export_run

    with opened_store(data_dir) as store:
        folder = out or Path(f"run-{run}")
        pages = pages_of(store.run(run).head.process)
        written = export_run(store, run, folder, pages=pages, single_file=single_file)
    typer.echo(written)


app.command("report")(report)
app.command("note")(note)


@app.command()
def gauge(
    run: Run,
    *,
    hole: Annotated[str, typer.Option(help="Name of the pin hole.")],
    mm: Annotated[float, typer.Option(help="Largest plug gauge that passes.")],
    source: Annotated[str, typer.Option(help="Who measured it.")],
    gauge_id: Annotated[str, typer.Option(help="Number on the plug gauge.")] = "",
    data_dir: DataDir = None,
) -> None:
    """Enter a plug-gauge result of a run; a later one of the same hole counts, all are kept."""
    with opened_store(data_dir) as store:
        # A gauge result comes after the run was sealed, so it has a seal of its own. Whoever types
        # can type any name: the audit log has the user beside it.
        entered = store.set_gauge(run, hole, mm, source, gauge_id)
        detail = {"run": run, "hole": hole, "diameter_mm": mm, "gauge_id": gauge_id}
        detail |= {BY: source, ENTERED: entered.isoformat()}
        store.audit(terminal_user(), GAUGE, detail)
        record = store.run(run)
        entries = gauge_entries(run, store.audit_log())
    for entry in record.gauge_history:
        if entry.hole == hole:
            typer.echo(f"run {run}, {gauge_line(record, entry, entries)}")


@app.command()
def verify(
    data_dir: DataDir = None,
    head: Annotated[str, typer.Option(help="LENGTH:HASH, as printed on a report.")] = "",
    *,
    as_json: AsJson = False,
) -> None:
    """Check that nothing that is sealed was changed, files included; exit code 1 if it was.

    Without --head entries that somebody has removed from the end together with their head are
    not found: the newest report has a head to compare with.
    """
    printed = printed_head(head)
    with opened_store(data_dir) as store:
        problems = store.verify(printed)
        newest = store.ledger_head()
    if as_json:
        typer.echo(as_plain({"problems": problems, "ledger_head": str(newest)}))
        raise typer.Exit(1 if problems else 0)
    for problem in problems:
        typer.echo(problem)
    if problems:
        raise typer.Exit(1)
    typer.echo("all closed runs are as they were sealed")
    typer.echo(f"ledger head {newest}", err=True)
