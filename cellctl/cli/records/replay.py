"""`cellctl replay`: compute a recorded run anew and compare."""

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from cellctl.cli.consoles import console_of_tables
from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.cli.records.runs import Run
from cellctl.config.process_definition import installed_processes, process_definition
from cellctl.errors.records import NotReplayable
from cellctl.records.entries import MAINTENANCE
from cellctl.records.replayed import Replayed
from cellctl.runtime.process import Process


def replay(
    run: Run,
    *,
    data_dir: DataDir = None,
    every: Annotated[bool, typer.Option("--every", help="Also what came out the same.")] = False,
) -> None:
    """Compute every measurement of a run anew from its raw images, poses and forces.

    With the code of today; exit code 1 when anything differs from the record.
    """
    lines = _replayed(run, data_dir)
    differing = [line for line in lines if not line.identical]
    shown = lines if every else differing
    if shown:
        console_of_tables().print(_table(shown))
    measurements = len({line.measurement for line in lines})
    same = len(lines) - len(differing)
    typer.echo(f"{measurements} measurements, {same} of {len(lines)} numbers are identical")
    if differing:
        raise typer.Exit(1)


def _replayed(run: int, data_dir: Path | None) -> list[Replayed]:
    with opened_store(data_dir) as store:
        record = store.run(run)
        if record.head.process == MAINTENANCE:
            raise NotReplayable(
                f"run {run} is the procedure {record.head.recipe_name}, whose record keeps what it "
                "has found and not the readings it was computed from"
            )
        calibrations = {one.id: one for one in store.calibrations()}
        process = _process(record.head.process)
        files = store.artefacts
        return list(process.replay(record, lambda one: files.get(one.sha256), calibrations))


def _process(name: str) -> type[Process[Any, Any, Any]]:
    if name in installed_processes():
        definition = process_definition(name)
        if issubclass(definition, Process):
            return definition
    raise NotReplayable(f"the process {name} is not installed")


def _table(lines: list[Replayed]) -> Table:
    table = Table("measurement", "number", "recorded", "computed", "difference", box=None)
    for line in lines:
        values = (
            "–" if value is None else f"{value:.9g} {line.unit}"
            for value in (
                line.recorded,
                line.computed,
            )
        )
        style = None if line.identical else "red"
        table.add_row(line.measurement, line.name, *values, f"{line.difference:.3g}", style=style)
    return table
