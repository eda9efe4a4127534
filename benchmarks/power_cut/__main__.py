"""`python -m benchmarks.power_cut`: a hundred power cuts for each kind of write, as a table."""

import random
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.power_cut.cut import Outcome, cut_while_writing
from benchmarks.power_cut.disk import PowerNotCut
from benchmarks.power_cut.writes import KINDS


def power_cuts(
    n: Annotated[int, typer.Option("-n", min=1, help="Cuts of each kind of write.")] = 100,
    seed: Annotated[int, typer.Option(help="Other moments with another seed.")] = 1,
) -> None:
    """Cut the power while records are written; exit code 1 when anything acknowledged is lost."""
    console = Console()
    table = Table("write", "cuts", "acknowledged", "lost", "problems of the ledger")
    good = True
    chance = random.Random(seed)
    for kind in KINDS:
        try:
            outcomes = [_one(kind, chance) for _ in track(range(n), kind, transient=True)]
        except PowerNotCut as error:
            console.print(f"no power can be cut here: {error}", style="red", markup=False)
            raise typer.Exit(1) from error
        lost = [name for outcome in outcomes for name in outcome.lost]
        problems = [text for outcome in outcomes for text in outcome.problems]
        acknowledged = sum(outcome.acknowledged for outcome in outcomes)
        good &= not lost and not problems
        table.add_row(kind, str(n), str(acknowledged), str(len(lost)), str(len(problems)))
        for text in [*lost, *problems][:5]:
            console.print(f"{kind}: {text}", style="red", markup=False)
    console.print(table)
    raise typer.Exit(0 if good else 1)


def _one(kind: str, chance: random.Random) -> Outcome:
    with tempfile.TemporaryDirectory() as folder:
        return cut_while_writing(kind, Path(folder), chance)


if __name__ == "__main__":
    typer.run(power_cuts)
