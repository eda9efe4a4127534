"""The deck assembled at planned viewpoints over planned ways, beside the taught ones.

``python -m benchmarks.planning.planned_demo -n 10`` plans viewpoints and ways of the shipped cell
as its engineer would, calibrates the fake cell there, and lets both cells make the same parts in
turn. What a folder has already is not made again. Exit code 1 when a part was not good, or when the
planned cell is worse than the taught one by more than the parts explain.
"""

import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.campaign import run_seed, told
from benchmarks.paired import mean_difference
from cellctl.geometry.pose import Array
from fakes.demo.ship import ship

CONFIG = Path(__file__).parents[2] / "config"
FIGURES = (
    ("lateral_mm", "lateral at pins, max mm"),
    ("rotation_deg", "true rotation, max deg"),
    ("seat_gap_mm", "seat gap mm"),
    ("peak_true_n", "peak true N"),
    ("run_s", "run s"),
)
NOT_ABOVE = ("lateral_mm", "run_s")
"""What planning has to pay for, or at least must not cost."""
_SIGMAS = 2.0


def compare(
    n: Annotated[int, typer.Option("-n", min=2, help="Number of seeds.")] = 10,
    first: Annotated[int, typer.Option(help="First seed.")] = 1,
    out: Annotated[Path, typer.Option(help="Folder for cell, runs and table.")] = Path(
        "runs/planned-demo"
    ),
) -> None:
    """Plan, calibrate, make parts in both cells, print one table."""
    console = Console(highlight=False, width=120)
    cell = planned_cell(out.resolve() / "cell", console)
    calibrate(cell, out / "calibration", console)
    rows: dict[str, list[dict[str, Any]]] = {"taught": [], "planned": []}
    for seed in range(first, first + n):
        for name, options in (("taught", []), ("planned", ["--cell", str(cell)])):
            rows[name].append(_result(seed, out / name, options, console))
    console.print(table(rows["taught"], rows["planned"]))
    bad = [one for one in (*rows["taught"], *rows["planned"]) if not one["passed"]]
    worse = [] if bad else above(rows["taught"], rows["planned"])
    for key in worse:
        console.print(f"{key} is above that of the taught cell", style="red")
    raise typer.Exit(1 if bad or worse else 0)


def planned_cell(folder: Path, console: Console) -> Path:
    """A copy of the shipped cell with planned viewpoints and ways; its calibrations are not yet."""
    planned = folder / "planned.toml"
    if planned.exists():
        return planned
    shutil.copytree(CONFIG, folder, dirs_exist_ok=True)
    views = folder / "views.toml"
    for name in ("views", "planned"):
        shutil.copyfile(folder / "deck.model.toml", folder / f"{name}.model.toml")
    shutil.copyfile(folder / "deck.scenario.toml", folder / "planned.scenario.toml")
    console.print("planning viewpoints and ways …")
    _command("cellctl", "plan", "viewpoints", str(folder / "deck.toml"), "--out", str(views))
    _command("cellctl", "plan", "paths", str(views), "--out", str(planned))
    return planned


def calibrate(cell: Path, out: Path, console: Console) -> None:
    """Run all procedures of the fake cell there; ADR 0004 says why without drift."""
    done = cell.parent / "calibrated"
    if done.exists():
        return
    console.print("calibrating at the planned poses, some ten minutes …")
    options = ["--calibrate", "--cell", str(cell), "--out", str(out), "--quiet"]
    for name in ("base_drift", "head_drift"):
        options += ["--imperfection", f"{name}=0"]
    _command("fakes", "demo", *options)
    ship(out, cell.parent / "demo-calibration")
    done.touch()


def _command(*words: str) -> None:
    subprocess.run([sys.executable, "-m", *words], check=True)


def _result(seed: int, out: Path, options: Sequence[str], console: Console) -> dict[str, Any]:
    kept = out / f"seed-{seed}" / "result.json"
    found: dict[str, Any] = json.loads(kept.read_text("utf-8")) if kept.exists() else {}
    if not found.get("passed"):
        found = run_seed(seed, out, options, console)
    else:
        console.print(f"{out.name}, seed {seed}: {told(found)}, from an earlier campaign")
    record = out / f"seed-{seed}" / "report" / "run.json"
    return {**found, "run_s": _run_s(record)} if record.exists() else found


def _run_s(record: Path) -> float:
    """From the start of the run to its end, by its record: without the start of the fake cell."""
    run = json.loads(record.read_text(encoding="utf-8"))
    began, ended = (datetime.fromisoformat(run[key]) for key in ("started", "ended"))
    return (ended - began).total_seconds()


def table(taught: Sequence[dict[str, Any]], planned: Sequence[dict[str, Any]]) -> Table:
    """Medians and greatest of both, and the mean difference with its standard deviation."""
    good = [sum(bool(one["passed"]) for one in some) for some in (taught, planned)]
    shown = Table(
        "median / max",
        f"taught, {good[0]} of {len(taught)} good",
        f"planned, {good[1]} of {len(planned)} good",
        "planned less taught",
    )
    for key, title in FIGURES:
        pairs = _pairs(taught, planned, key)
        if len(pairs) > 1:
            columns = [f"{np.median(some):.4f} / {some.max():.4f}" for some in pairs.T]
            mean, sigma = mean_difference(pairs)
            shown.add_row(title, *columns, f"{mean:+.4f} ± {sigma:.4f}")
    return shown


def above(taught: Sequence[dict[str, Any]], planned: Sequence[dict[str, Any]]) -> list[str]:
    """Figures of which the planned cell has more, by more than the scatter of the differences."""
    found = []
    for key in NOT_ABOVE:
        mean, sigma = mean_difference(_pairs(taught, planned, key))
        if mean > _SIGMAS * sigma:
            found.append(key)
    return found


def _pairs(taught: Sequence[dict[str, Any]], planned: Sequence[dict[str, Any]], key: str) -> Array:
    """Values of seeds that both have, shape (n, 2)."""
    both = [
        (one[key], other[key])
        for one, other in zip(taught, planned, strict=True)
        if key in one and key in other
    ]
    return np.array(both, dtype=float).reshape(-1, 2)


if __name__ == "__main__":
    typer.run(compare)
