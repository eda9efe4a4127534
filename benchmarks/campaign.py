"""Many seeds of the demonstration in a row: `python -m benchmarks.campaign -n 20`."""

import json
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

COLUMNS = (
    ("iterations", "iterations", "{:.0f}"),
    ("lateral_mm", "lateral at pins, max mm", "{:.4f}"),
    ("rotation_deg", "true rotation, max deg", "{:.5f}"),
    ("seat_gap_mm", "seat gap mm", "{:.4f}"),
    ("peak_true_n", "peak true N", "{:.1f}"),
    ("peak_sensed_n", "peak sensed N", "{:.1f}"),
    ("final_true_n", "final true N", "{:.1f}"),
    ("gauge_min_mm", "smallest gauge mm", "{:.2f}"),
    ("wall_s", "wall s", "{:.0f}"),
    ("lost_s", "lost by the fake s", "{:.2f}"),
)
COMPONENTS = ("x mm", "y mm", "z mm", "rx °", "ry °", "rz °")


def campaign(
    n: Annotated[int, typer.Option("-n", min=1, help="Number of seeds.")] = 20,
    first: Annotated[int, typer.Option(help="First seed.")] = 1,
    out: Annotated[Path, typer.Option(help="Folder for the runs and the table.")] = Path(
        "runs/campaign"
    ),
    imperfection: Annotated[
        list[str] | None,
        typer.Option(
            help="NAME=SCALE for every run; may repeat. See `python -m fakes imperfections`."
        ),
    ] = None,
) -> None:
    """Run the seeds, print a table, write campaign.json; exit code 1 when a run was not good."""
    console = Console(highlight=False, width=150)
    out.mkdir(parents=True, exist_ok=True)
    options = [part for scale in imperfection or () for part in ("--imperfection", scale)]
    results = [run_seed(seed, out, options, console) for seed in range(first, first + n)]
    (out / "campaign.json").write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    console.print(_table(results))
    good = [result for result in results if result["passed"]]
    if good:
        console.print(_statistics(good))
        console.print(decay(good))
        console.print(normalised(good))
    for result in results:
        if not result["passed"]:
            why = result["fault"] or "beyond its limit: " + ", ".join(result.get("beyond", ()))
            console.print(f"seed {result['seed']}: {why}", style="red")
    console.print(f"{len(good)} of {len(results)} good; figures in {out / 'campaign.json'}")
    raise typer.Exit(0 if len(good) == len(results) else 1)


def run_seed(seed: int, out: Path, options: Sequence[str], console: Console) -> dict[str, Any]:
    """One demonstration in a folder of its own below ``out``: its ``result.json``, and how long it
    took."""
    folder = out / f"seed-{seed}"
    path = folder / "result.json"
    path.unlink(missing_ok=True)  # that of an earlier campaign is no result of this one
    command = ["-m", "fakes", "demo", "--seed", str(seed), "--out", str(folder), "--quiet"]
    command += options
    begun = time.monotonic()
    errors = _run_to_its_end([sys.executable, *command])
    wall_s = time.monotonic() - begun
    if path.exists():
        result: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    else:
        tail = "\n".join(errors.splitlines()[-5:])
        result = {"seed": seed, "passed": False, "fault": f"no result: {tail}"}
    result["wall_s"] = wall_s
    console.print(f"seed {seed}: {told(result)} in {wall_s:.0f} s")
    return result


def _run_to_its_end(command: Sequence[str]) -> str:
    """What the program has written as errors. Ctrl-C waits until it has ended what it started."""
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            return process.communicate()[1]
        except KeyboardInterrupt:
            process.terminate()
            process.wait(60)
            raise


def told(result: Mapping[str, Any]) -> str:
    """How a run ended, in words. A bad part that the cell called good is the worst of all ends."""
    if result["passed"]:
        return "good"
    return "CALLED GOOD, IS NOT" if result.get("result") == "good" else "not good, and called so"


def _table(results: list[dict[str, Any]]) -> Table:
    table = Table("seed", "result", *(title for _, title, _ in COLUMNS), title="campaign")
    for result in results:
        cells = [
            form.format(result[key]) if isinstance(result.get(key), int | float) else "–"
            for key, _, form in COLUMNS
        ]
        table.add_row(str(result["seed"]), told(result), *cells)
    return table


def _statistics(good: list[dict[str, Any]]) -> Table:
    table = Table("figure", "median", "p95", "max", title=f"{len(good)} good runs")
    for key, title, form in COLUMNS:
        values = [result[key] for result in good if isinstance(result.get(key), int | float)]
        if values:
            numbers = (np.median(values), np.percentile(values, 95), np.max(values))
            table.add_row(title, *(form.format(number) for number in numbers))
    return table


def decay(good: list[dict[str, Any]]) -> Table:
    """What each look of the loop found, and how many runs needed it: figure 11 of the paper."""
    table = Table(
        "look", "runs", "needed no other", *COMPONENTS, title="errors of the loop, median / max"
    )
    histories = [np.abs(np.array(one["errors_mm_deg"], float)) for one in good]
    for look in range(max((len(errors) for errors in histories), default=0)):
        found = np.array([errors[look] for errors in histories if len(errors) > look])
        last = sum(len(errors) == look + 1 for errors in histories)
        columns = zip(np.median(found, axis=0), found.max(axis=0), strict=True)
        cells = [f"{middle:.4f} / {most:.4f}" for middle, most in columns]
        table.add_row(str(look + 1), str(len(found)), str(last), *cells)
    return table


def normalised(good: list[dict[str, Any]]) -> Table:
    """What the cameras were off the truth of the seated deck, over what they said; 1 is honest."""
    table = Table("errors over stated sigma", *COMPONENTS, title="look at the seated deck")
    errors = [one["seat_normalised"] for one in good if one.get("seat_normalised")]
    if errors:
        rms = np.sqrt(np.mean(np.square(np.array(errors, float)), axis=0))
        table.add_row(f"rms of {len(errors)}", *(f"{value:.2f}" for value in rms))
    return table


if __name__ == "__main__":
    typer.run(campaign)
