"""`cellctl replay`: compute a recorded run anew and compare."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from cellctl.cli.records.run_store import DataDir, opened_store
from cellctl.cli.records.runs import Run
from cellctl.config.process_definition import installed_processes, process_definition
from cellctl.errors.records.store import NotReplayable
from cellctl.records.entries import MAINTENANCE
from cellctl.records.files.artefacts import CELL_FILE
from cellctl.records.replay.recorded_run import RecordedRun
from cellctl.records.replay.replayed import Replayed
from cellctl.runtime.procedure import ProcedureReplay
from cellctl.runtime.process import Process
from cellctl.terminal.consoles import console_of_tables


def replay(
    run: Run,
    *,
    data_dir: DataDir = None,
    every: Annotated[bool, typer.Option("--every", help="Also what came out the same.")] = False,
) -> None:
    """Compute every measurement of a run anew from its raw images, poses and forces.

    Of a procedure its result too. With the code of today; exit code 1 when anything differs from
    the record.
    """
    lines = _replayed(run, data_dir)
    # "0 of 0 numbers are identical" with a good exit code would pass for a comparison.
    if not lines:
        raise NotReplayable(f"run {run} has no number that could be compared")
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
        record, files = store.run(run), store.artefacts
        calibrations = {one.id: one for one in store.calibrations()}
        recorded = RecordedRun(record, lambda one: files.get(one.sha256), calibrations)
        if record.head.process == MAINTENANCE:
            return list(_procedure(recorded)(recorded))
        process = _process(record.head.process)
        return list(process.replay(record, recorded.read, calibrations))


def _procedure(run: RecordedRun) -> ProcedureReplay:
    """How the procedure of a run is computed anew: a process of its cell knows that."""
    head = run.record.head
    names = list(json.loads(run.file(CELL_FILE))["processes"])
    for name in names:
        if name in installed_processes():
            found = _process(name).procedure_replays().get(head.recipe_id)
            if found is not None:
                return found
    raise NotReplayable(
        f"run {head.number} is the procedure {head.recipe_name}, which no installed process of "
        f"its cell ({', '.join(names) or 'none'}) computes anew"
    )


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
