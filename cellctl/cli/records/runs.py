"""`cellctl runs`: look into the run store; enter what a person measured."""

from collections.abc import Sequence, Set
from dataclasses import asdict
from datetime import datetime, timedelta
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.cli.os_user import terminal_user
from cellctl.cli.records.plain_json import as_plain
from cellctl.cli.records.run_mcap import Images, write_mcap
from cellctl.cli.records.run_note import note
from cellctl.cli.records.run_report import report
from cellctl.cli.records.run_store import DataDir, opened_store, store_folder
from cellctl.cli.records.trend import trend
from cellctl.records.entered.gauges import gauge_limits, judge_gauge, part_verdict
from cellctl.records.entered.notes import note_words, notes_of
from cellctl.records.entered.said_by import BY, ENTERED, GAUGE, gauge_entries, measured_by, said_by
from cellctl.records.entries import AuditEntry, Figure, Gauge, LoopPass, RunHead, RunRecord, Verdict
from cellctl.records.figures import NO_LIMIT
from cellctl.records.outcome import GOOD_ENDS, outcome
from cellctl.records.report.acceptance.faults import fault_box
from cellctl.records.report.acceptance.timeline import during
from cellctl.records.report.text import decimals, duration, fixed, number, quantity
from cellctl.records.run_filter import RunFilter
from cellctl.records.run_list import listed_runs
from cellctl.records.seals import LedgerHead

app = typer.Typer(help="Look into the run store.", no_args_is_help=True)

AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]
Run = Annotated[int, typer.Argument(help="Number of the run.", min=1)]

DAY = ["%Y-%m-%d"]
HASH_DIGITS = 64
WIDE = 100
"""Columns from which on the list has the name of the process."""
_COLOURS = {"open": "yellow", **dict.fromkeys(GOOD_ENDS, "green")}


app.command("trend")(trend)


@app.command("list")
def list_runs(
    data_dir: DataDir = None,
    limit: Annotated[int, typer.Option(help="How many, newest first.", min=1)] = 20,
    *,
    serial: Annotated[str, typer.Option(help="Only this serial number.")] = "",
    recipe: Annotated[str, typer.Option(help="Only of the recipe with this name.")] = "",
    operator: Annotated[str, typer.Option(help="Only this operator's.")] = "",
    result: Annotated[
        str, typer.Option(help="good, bad, stopped, aborted, interrupted, open.")
    ] = "",
    fault: Annotated[int | None, typer.Option(help="Only where it came up.", min=1)] = None,
    calibration: Annotated[str, typer.Option(help="Only what used it; its identity.")] = "",
    since: Annotated[datetime | None, typer.Option(help="First day.", formats=DAY)] = None,
    until: Annotated[datetime | None, typer.Option(help="Last day.", formats=DAY)] = None,
    as_json: AsJson = False,
) -> None:
    """The newest runs; of all that fulfil every condition that is given."""
    wanted = RunFilter(
        serial=serial,
        recipe=recipe,
        operator=operator,
        result=result,
        fault=fault,
        calibration=calibration,
        # A day without a zone is one of this computer's, and the last one counts to its end.
        since=since and since.astimezone(),
        until=until and (until + timedelta(days=1)).astimezone(),
    )
    found = listed_runs(store_folder(data_dir), limit, wanted)
    if as_json:
        typer.echo(as_plain([asdict(one.head) | {"spoilt": one.spoilt} for one in found]))
        return
    if not found:
        typer.echo("no runs")
        return
    spoilt = {one.head.number for one in found if one.spoilt}
    console = Console()
    console.print(_table([one.head for one in found], spoilt, wide=console.width >= WIDE))


@app.command()
def show(run: Run, data_dir: DataDir = None, *, as_json: AsJson = False) -> None:
    """One run in figures."""
    with opened_store(data_dir) as store:
        record = store.run(run)
        audit = store.audit_log()
    notes, entered = notes_of(run, audit), gauge_entries(run, audit)
    if as_json:
        typer.echo(as_plain(asdict(record) | {"notes": [asdict(note) for note in notes]}))
        return
    console = Console()
    console.print(_table([record.head], wide=console.width >= WIDE))
    if ended := fault_box(record, during(record, audit)):
        # Also a run that a command has ended: by whom, and in which step.
        where = f"step {ended.step}" if record.phases else ended.step
        console.print(f"{ended.text}; {where}", style="red", markup=False)
    for loop in dict.fromkeys(entry.loop for entry in record.passes):
        console.print(_passes([entry for entry in record.passes if entry.loop == loop]))
    judged = [entry for entry in record.newest_figures.values() if entry.verdict is not None]
    if judged:
        console.print(_figures(judged))
    for gauge in record.gauge_history:
        console.print(_gauge_line(record, gauge, entered), markup=False)
    if part_verdict(record) != record.head.result:
        console.print("the part is bad: a plug gauge is beyond its limit", style="bold red")
    for alarm in record.alarms:
        console.print(f"alarm {alarm.text}", markup=False)
    for entry in notes:
        console.print(f"note of {said_by(entry)}: {note_words(entry)}", markup=False)


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
            typer.echo(f"run {run}, {_gauge_line(record, entry, entries)}")


@app.command()
def verify(
    data_dir: DataDir = None,
    head: Annotated[str, typer.Option(help="LENGTH:HASH, as printed on a report.")] = "",
) -> None:
    """Check that nothing that is sealed was changed, files included; exit code 1 if it was.

    Without --head entries that somebody has removed from the end together with their head are
    not found: the newest report has a head to compare with.
    """
    printed = _printed(head)
    with opened_store(data_dir) as store:
        problems = store.verify(printed)
        newest = store.ledger_head()
    for problem in problems:
        typer.echo(problem)
    if problems:
        raise typer.Exit(1)
    typer.echo("all closed runs are as they were sealed")
    typer.echo(f"ledger head {newest}", err=True)


def _printed(head: str) -> LedgerHead | None:
    """From the text on a report; raises ``typer.BadParameter``."""
    if not head:
        return None
    length, _, found = head.partition(":")
    if not length.isdecimal() or len(found) != HASH_DIGITS:
        raise typer.BadParameter("it reads LENGTH:HASH", param_hint="--head")
    return LedgerHead(int(length), found)


def _gauge_line(record: RunRecord, entry: Gauge, entered: Sequence[AuditEntry]) -> str:
    """One entry with who, when, with which gauge, and what it says."""
    verdict = judge_gauge(record, entry)
    least_mm = gauge_limits(record).get(entry.hole, NO_LIMIT).lower
    limit = "" if least_mm is None else f", at least {least_mm:.2f} mm: {verdict}"
    with_gauge = f", gauge {entry.gauge_id}" if entry.gauge_id else ""
    replaced = "" if entry in record.gauges else ", replaced by a later entry"
    return (
        f"pin hole {entry.hole}: gauge {entry.diameter_mm:.2f} mm ({measured_by(entry, entered)})"
        f"{limit}{with_gauge}, {entry.time:%Y-%m-%d %H:%M}{replaced}"
    )


def _table(runs: Sequence[RunHead], spoilt: Set[int] = frozenset(), *, wide: bool = True) -> Table:
    """One line a run; ``spoilt``: runs with a good result and a gauge beyond its limit."""
    table = Table(box=None)
    for name in ("run", "serial", "recipe", *(("process",) if wide else ())):
        # Folded and not cut: a number that is cut is another one.
        table.add_column(name, no_wrap=name == "run", overflow="fold")
    for name in ("mode", "started (UTC)", "duration", "result"):
        table.add_column(name, no_wrap=True)
    for head in runs:
        table.add_row(*_row(head, spoilt=head.number in spoilt, wide=wide))
    return table


def _row(head: RunHead, *, spoilt: bool, wide: bool) -> tuple[str, ...]:
    result = outcome(head.mode, head.result, spoilt=spoilt)
    colour = _COLOURS.get(result, "red")
    mark = " (sim)" if head.simulated else ""
    return (
        str(head.number),
        head.serial + mark,
        head.recipe_name,
        *((head.process,) if wide else ()),
        head.mode.lower(),
        f"{head.started:%Y-%m-%d %H:%M}",
        duration(head.started, head.ended),
        f"[{colour}]{result}[/]",
    )


def _passes(passes: Sequence[LoopPass]) -> Table:
    last = passes[-1].components
    names = (f"{component.name} {component.unit}".rstrip() for component in last)
    table = Table("pass", *names, "µm", box=None)
    for entry in passes:
        errors = (
            fixed(component.value, decimals(component.unit), signed=True)
            for component in entry.components
        )
        table.add_row(str(entry.number), *errors, fixed(entry.residual_um, 1))
    limits = (f"± {number(component.limit or 0.0)}" for component in last)
    table.add_row("limit", *limits, "", style="dim")
    return table


def _figures(judged: Sequence[Figure]) -> Table:
    table = Table("figure", "value", "at least", "at most", "verdict", box=None)
    for entry in judged:
        texts = (quantity(value, entry.unit) for value in (entry.value, entry.lower, entry.upper))
        style = "green" if entry.verdict is Verdict.PASS else "red"
        table.add_row(entry.label, *texts, f"[{style}]{entry.verdict}[/]")
    return table
