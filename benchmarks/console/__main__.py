"""Times each command beside a bare start of Python with the same libraries of the terminal.

`python -m benchmarks.console` prints the fastest, the middle and the slowest of several runs. The
commands take turns, so that a busy moment of the machine falls on all of them.
"""

import statistics
import subprocess
import sys
import time
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

BARE = "bare typer, rich"
COMMANDS = (
    "--help",
    "status",
    "faults 207",
    "runs list --data-dir absent",
    "check config/deck.toml",
)


def program(command: str) -> list[str]:
    """What is started; the refusals of a missing daemon or store take as long as an answer."""
    if command == BARE:
        return [sys.executable, "-c", "import typer, rich"]
    return [sys.executable, "-m", "cellctl", *command.split()]


def wall_s(command: str) -> float:
    """One run from its start to its end."""
    began_s = time.perf_counter()
    subprocess.run(program(command), capture_output=True, check=False)
    return time.perf_counter() - began_s


def main(runs: Annotated[int, typer.Option(help="Of each command.", min=1)] = 7) -> None:
    """Print the times of every command."""
    names = (BARE, *COMMANDS)
    taken: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(runs):
        for name in names:
            taken[name].append(wall_s(name))
    table = Table("command", "fastest s", "median s", "slowest s", box=None)
    for name, times_s in taken.items():
        figures = (min(times_s), statistics.median(times_s), max(times_s))
        table.add_row(name, *(f"{figure_s:.2f}" for figure_s in figures))
    Console().print(table)


if __name__ == "__main__":
    typer.run(main)
