"""Command line: `python -m benchmarks.soak --minutes 60`."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from benchmarks.soak.cell import Cycle, Died, SoakedCell, processors
from benchmarks.soak.chart import TITLES, draw
from benchmarks.soak.trend import BOUNDS, Looked, Trend, Verdict, trends

_STYLES = {Verdict.FLAT: "green", Verdict.UNDECIDED: "yellow", Verdict.GROWS: "bold red"}


def main(
    minutes: Annotated[float, typer.Option(min=1.0, help="How long parts are made.")] = 60.0,
    out: Annotated[Path | None, typer.Option(help="Folder for figures and picture.")] = None,
) -> None:
    """Make parts, print what each process kept; exit code 1 unless all of it is surely flat.

    Not flat are also a part that is not good and a process that ends. Bounds are those of
    ``trend.BOUNDS``; an interval that reaches beyond its bound asks for a longer run.
    """
    console = Console(highlight=False, width=130)
    folder = out or Path("runs") / f"soak-{datetime.now(UTC):%Y%m%d-%H%M%S}"
    folder.mkdir(parents=True, exist_ok=True)
    console.print(f"{minutes:g} minutes on {processors()} processors; files in {folder}/")

    def tell(cycle: Cycle) -> None:
        how = "good" if cycle.good else f"NOT GOOD: {cycle.said}"
        console.print(f"{cycle.time_s / 60.0:6.1f} min  {how}", markup=False)

    try:
        with SoakedCell.start(folder) as cell:
            looked = cell.run(minutes, tell)
        # Kept also where it is too little to be judged.
        write_figures(folder, cell.cycles, looked)
        found = [trend for one in looked for trend in trends(one)]
    except (Died, ValueError) as error:
        console.print(str(error), style="bold red", markup=False)
        raise typer.Exit(1) from None
    draw(looked, found, folder / "soak.png")
    console.print(table(found))
    bad = [cycle for cycle in cell.cycles if not cycle.good]
    console.print(f"{len(cell.cycles) - len(bad)} of {len(cell.cycles)} parts are good")
    flat = all(trend.verdict is Verdict.FLAT for trend in found)
    raise typer.Exit(0 if flat and not bad else 1)


def write_figures(folder: Path, cycles: Sequence[Cycle], looked: Sequence[Looked]) -> None:
    """Everything that was read."""
    document = {
        "cycles": [asdict(cycle) for cycle in cycles],
        "kept": [asdict(one) for one in looked],
        "bounds_per_hour": BOUNDS,
    }
    (folder / "soak.json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def table(found: Sequence[Trend]) -> Table:
    """One line a process and quantity."""
    names = "process", "kept", "first", "last", "slope an hour", "95 %", "bound", ""
    shown = Table(*names, title="what was kept after each part")
    for trend in found:
        scale = 1e-3 if trend.quantity == "memory_kb" else 1.0
        numbers = trend.first, trend.last, trend.slope, trend.low, trend.high, trend.bound
        first, last, slope, low, high, bound = (scale * number for number in numbers)
        shown.add_row(
            trend.process,
            TITLES[trend.quantity],
            f"{first:.1f}",
            f"{last:.1f}",
            f"{slope:+.2f}",
            f"{low:+.2f} … {high:+.2f}",
            f"{bound:g}",
            f"[{_STYLES[trend.verdict]}]{trend.verdict}[/]",
        )
    return shown


if __name__ == "__main__":
    typer.run(main)
