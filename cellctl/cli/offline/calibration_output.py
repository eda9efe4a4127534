"""How every offline calibration ends: checks, files, and the verdict as exit code."""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Protocol

import typer
from rich.console import Console

from cellctl.calibration.checks import Checks
from cellctl.calibration.output_file import write_file
from cellctl.terminal.consoles import console_of_lines, print_hanging

NOT_PASSED = 3
"""Exit code when a figure of the result is beyond its limit."""

Picture = Annotated[Path | None, typer.Option(help="Write the evidence as PNG.")]


class JudgedFigure(Protocol):
    """A figure that reads as one with its limit."""

    @property
    def passed(self) -> bool:
        """Whether it keeps its limit."""


class CalibrationResult(Protocol):
    """The members that the results of all calibrations have."""

    @property
    def checks(self) -> Checks:
        """Figures against limits."""

    @property
    def passed(self) -> bool:
        """The verdict."""

    def to_record(self) -> dict[str, object]:
        """Plain data."""


def print_checks(console: Console, checks: Iterable[JudgedFigure]) -> None:
    """Every figure with its limit and verdict."""
    for check in checks:
        print_hanging(console, f"  {'ok  ' if check.passed else 'FAIL'}  {check}", 8)


def finish(
    result: CalibrationResult,
    warnings: tuple[str, ...],
    out: Path | None,
    picture: Path | None,
    draw: Callable[[], bytes],
) -> None:
    """Print the checks, write the files, and leave with the verdict as exit code."""
    console = console_of_lines()
    print_checks(console, result.checks)
    for warning in warnings:
        print_hanging(console, f"  warning: {warning}", 11)
    # Also when it did not pass: the figures show why, and the exit code keeps a script from using
    # it.
    if out is not None:
        write_file(out, json.dumps(result.to_record(), indent=2).encode() + b"\n")
    if picture is not None:
        write_file(picture, draw())
    console.print("passed" if result.passed else "NOT passed")
    if not result.passed:
        raise typer.Exit(NOT_PASSED)
