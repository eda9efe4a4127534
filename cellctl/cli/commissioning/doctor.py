"""`cellctl doctor`: whether this PC can run the cell."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cellctl.cli.consoles import console_of_lines
from cellctl.cli.nearest_cell import SERVICE_CELL
from cellctl.doctor.diagnosis import Subject, diagnose
from cellctl.doctor.finding import Finding, Health

_MARKS = {
    Health.GOOD: ("✓", "green"),
    Health.DOUBTFUL: ("!", "yellow"),
    Health.BAD: ("✗", "bold red"),
}


def doctor(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")] = SERVICE_CELL,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Examine this PC: program, users, real-time rights, clock, disk, network; each with a remedy.

    Changes nothing and speaks to no device. Exit code 1 when something keeps the service from
    running.
    """
    subjects = list(diagnose(cell_file))
    if as_json:
        typer.echo(json.dumps([asdict(subject) for subject in subjects], indent=2))
    else:
        _print(subjects)
    if any(subject.health is Health.BAD for subject in subjects):
        raise typer.Exit(1)


def _print(subjects: list[Subject]) -> None:
    console = console_of_lines()
    for subject in subjects:
        console.print(subject.title, style="bold")
        for finding in subject.findings:
            _print_finding(console, finding)
    counts = [
        sum(finding.health is health for subject in subjects for finding in subject.findings)
        for health in (Health.BAD, Health.DOUBTFUL)
    ]
    console.print(f"{counts[0]} bad, {counts[1]} doubtful", style="bold")


def _print_finding(console: Console, finding: Finding) -> None:
    mark, style = _MARKS[finding.health]
    console.print(f"  {mark} {finding.subject}: {finding.found}", style=style)
    if finding.remedy:
        console.print(f"      {finding.remedy}")
