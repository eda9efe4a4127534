"""`cellctl doctor`: whether this PC can run the cell."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from cellctl.cli.nearest_cell import SERVICE_CELL
from cellctl.doctor.diagnosis import Subject, diagnose
from cellctl.doctor.finding import Finding, Health
from cellctl.terminal.consoles import console_of_lines, print_hanging

_MARKS = {
    Health.GOOD: ("✓", "green"),
    Health.DOUBTFUL: ("!", "yellow"),
    Health.BAD: ("✗", "bold red"),
}
_FOUND, _REMEDY = 4, 6
"""Where the text of a finding and that of its remedy begin."""


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
        show(console_of_lines(), subjects)
    if any(subject.health is Health.BAD for subject in subjects):
        raise typer.Exit(1)


def show(console: Console, subjects: Sequence[Subject]) -> None:
    """Every finding with its remedy; on a terminal their lines go on below their text."""
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
    print_hanging(console, f"  {mark} {finding.subject}: {finding.found}", _FOUND, style)
    if finding.remedy:
        print_hanging(console, f"{'':{_REMEDY}}{finding.remedy}", _REMEDY)
