"""`cellctl runs`: look into the run store; enter what a person measured."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.errors import CellError
from cellctl.records.entries import RunHead, RunRecord
from cellctl.records.report import export_run
from cellctl.records.report.text import duration, fixed, number
from cellctl.records.store import RunStore

app = typer.Typer(help="Look into the run store.", no_args_is_help=True)

DataDir = Annotated[Path, typer.Option("--data-dir", help="Folder of the run store.")]
Run = Annotated[int, typer.Argument(help="Number of the run.", min=1)]
DEFAULT = Path("runs")

_COLOURS = {"good": "green", None: "yellow"}


@contextmanager
def _store(data_dir: Path) -> Iterator[RunStore]:
    store = RunStore(data_dir, create=False)
    try:
        yield store
    finally:
        store.close()


@app.command("list")
def list_runs(
    data_dir: DataDir = DEFAULT,
    serial: Annotated[str | None, typer.Option(help="Only this serial number.")] = None,
    limit: Annotated[int, typer.Option(help="How many, newest first.", min=1)] = 20,
) -> None:
    """The newest runs."""
    with _store(data_dir) as store:
        runs = store.runs(limit, serial)
    if not runs:
        typer.echo("no runs")
        return
    Console().print(_table(runs))


@app.command()
def show(run: Run, data_dir: DataDir = DEFAULT) -> None:
    """One run in figures."""
    with _store(data_dir) as store:
        record = store.run(run)
    console = Console()
    console.print(_table([record.head]))
    if record.head.fault:
        console.print(record.head.fault, style="red", markup=False)
    if record.iterations:
        console.print(_iterations(record))
    for gauge in record.gauges:
        console.print(f"pin hole {gauge.hole}: gauge {gauge.diameter_mm:.2f} mm ({gauge.source})")
    for alarm in record.alarms:
        console.print(f"alarm {alarm.text}", markup=False)


@app.command()
def export(
    run: Run,
    *,
    out: Annotated[Path | None, typer.Option(help="Folder; default: run-NUMBER.")] = None,
    data_dir: DataDir = DEFAULT,
    single_file: Annotated[
        bool, typer.Option("--single-file", help="Pictures inside the report.")
    ] = False,
) -> None:
    """Write record, report, pictures and recordings of a run into a folder."""
    with _store(data_dir) as store:
        folder = out or Path(f"run-{run}")
        typer.echo(export_run(store, run, folder, single_file=single_file))


@app.command()
def gauge(
    run: Run,
    hole: Annotated[str, typer.Option(help="Name of the pin hole.")],
    mm: Annotated[float, typer.Option(help="Largest plug gauge that passes.")],
    source: Annotated[str, typer.Option(help="Who measured it.")],
    data_dir: DataDir = DEFAULT,
) -> None:
    """Enter a plug-gauge result of a run."""
    with _store(data_dir) as store:
        store.set_gauge(run, hole, mm, source)
        store.audit(source, "gauge", {"run": run, "hole": hole, "diameter_mm": mm})
    typer.echo(f"run {run}, hole {hole}: {mm:.2f} mm by {source}")


@app.command()
def verify(data_dir: DataDir = DEFAULT) -> None:
    """Check that nothing that is closed was changed, files included; exit code 1 if it was."""
    with _store(data_dir) as store:
        problems = store.verify()
        for head in store.runs(limit=1_000_000):
            problems += _damaged(store, store.run(head.number))
    for problem in problems:
        typer.echo(problem)
    if problems:
        raise typer.Exit(1)
    typer.echo("all closed runs are as they were sealed")


def _damaged(store: RunStore, record: RunRecord) -> list[str]:
    found = []
    for artefact in record.artefacts:
        try:
            store.artefacts.get(artefact.sha256)
        except CellError as error:
            found.append(f"run {record.head.number}, {artefact.name}: {error}")
    return found


def _table(runs: Sequence[RunHead]) -> Table:
    table = Table(box=None)
    for name in ("run", "serial", "recipe", "mode", "started (UTC)", "duration", "result"):
        table.add_column(name, no_wrap=name in {"run", "mode", "duration", "result"})
    for head in runs:
        table.add_row(*_row(head))
    return table


def _row(head: RunHead) -> tuple[str, ...]:
    result = head.result or "open"
    colour = _COLOURS.get(head.result, "red")
    mark = " (sim)" if head.simulated else ""
    return (
        str(head.number),
        head.serial + mark,
        head.recipe_name,
        head.mode.lower(),
        f"{head.started:%Y-%m-%d %H:%M:%S}",
        duration(head.started, head.ended),
        f"[{colour}]{result}[/]",
    )


def _iterations(record: RunRecord) -> Table:
    names = ("pass", "X mm", "Y mm", "Z mm", "rx °", "ry °", "rz °", "µm")
    table = Table(*names, box=None)
    for entry in record.iterations:
        errors = entry.error_mm_deg
        lengths = [fixed(error, 4, signed=True) for error in errors[:3]]
        angles = [fixed(error, 5, signed=True) for error in errors[3:]]
        table.add_row(str(entry.iteration), *lengths, *angles, fixed(entry.residual_um, 1))
    thresholds = (f"± {number(value or 0.0)}" for value in record.iterations[-1].threshold_mm_deg)
    table.add_row("limit", *thresholds, "", style="dim")
    return table
