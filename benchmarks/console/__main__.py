"""Times each command beside a bare start of Python with the same libraries of the terminal.

`python -m benchmarks.console` prints the fastest, the middle and the slowest of several runs. The
commands take turns, so that a busy moment of the machine falls on all of them.
"""

import statistics
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from cellctl.records import RunResult, RunStore
from cellctl.records.entries import PRODUCTION

BARE = "bare typer, rich"
COMMANDS = (
    "--help",
    "status",
    "faults 207",
    "runs list",
    "check config/small.toml",
    "check config/deck.toml",
)
RUNS = 20
"""Runs in the store that is listed: as many as a list shows."""


def program(command: str, store: Path) -> list[str]:
    """What is started; the refusal of a missing daemon takes as long as an answer."""
    if command == BARE:
        return [sys.executable, "-c", "import typer, rich"]
    of_store = ["--data-dir", str(store)] if command.startswith("runs") else []
    return [sys.executable, "-m", "cellctl", *command.split(), *of_store]


def wall_s(command: str, store: Path) -> float:
    """One run from its start to its end."""
    began_s = time.perf_counter()
    subprocess.run(program(command, store), capture_output=True, check=False)
    return time.perf_counter() - began_s


def fill(folder: Path) -> None:
    """A store with good parts that were gauged."""
    store = RunStore(folder)
    try:
        for number in range(1, RUNS + 1):
            run = store.start_run(
                process="deck-to-frame",
                serial=f"SAT-{number:04d}",
                recipe_id=1,
                recipe_name="panel 500 x 1000",
                recipe_hash="00" * 32,
                mode=PRODUCTION,
                software="benchmark",
                config_hash="00" * 32,
                calibration_ids={},
                simulated=True,
            )
            store.close_run(run, RunResult.GOOD)
            store.set_gauge(run, "P1", 5.95, "benchmark")
    finally:
        store.close()


def main(runs: Annotated[int, typer.Option(help="Of each command.", min=1)] = 7) -> None:
    """Print the times of every command."""
    names = (BARE, *COMMANDS)
    taken: dict[str, list[float]] = {name: [] for name in names}
    with TemporaryDirectory() as folder:
        fill(Path(folder))
        for _ in range(runs):
            for name in names:
                taken[name].append(wall_s(name, Path(folder)))
    table = Table("command", "fastest s", "median s", "slowest s", box=None)
    for name, times_s in taken.items():
        figures = (min(times_s), statistics.median(times_s), max(times_s))
        table.add_row(name, *(f"{figure_s:.2f}" for figure_s in figures))
    Console().print(table)


if __name__ == "__main__":
    typer.run(main)
