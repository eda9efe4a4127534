"""Matings onto dowel pins, beside their place by more than the clearance, rigid and giving way.

Run with ``make campaign-mating`` or alone. Prints tables, writes
``runs/campaign-mating-pins.json``; exit code 1 when giving way misses a requirement: every deck is
called seated at its first attempt, none of them sits otherwise (``Trial.false_complete``), and no
true force reaches 50 N.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.insertion.wilson import wilson_bounds
from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.mating.settings import PinSettings
from tests.rigs.mating.cell import THRESHOLD
from tests.rigs.mating.trial import PIN_LIMIT_MM, PINS, Trial, draw_trial, run_trial

LIMIT_N = 50.0
WORKERS = 2
RESULT = Path("runs") / "campaign-mating-pins.json"
BESIDE_MM = (0.04, 0.15)
"""Offsets from the clearance to the middle of the chamfer; the measuring loop allows 0.05 per
axis."""
YAW_DEG = 0.008
FIGURES = (
    ("true_pin_error_mm", "true distance of pin and hole, mm", f"{PIN_LIMIT_MM:g}"),
    ("true_gap_mm", "true gap of the middle, mm", "± 0.1"),
    ("true_opening_mm", "greatest true opening at a pad, mm", ""),
    ("true_peak_n", "true peak of all contact forces, N", f"{LIMIT_N:g}"),
    ("final_true_n", "true force held, N", "35 … 45"),
    ("peak_lateral_n", "greatest side force, N", "25"),
    ("final_lateral_n", "side force held, N", "20"),
    ("gave_way_mm", "gave way, mm", "0.2"),
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=12, help="number of draws")
    parser.add_argument("--seed", type=int, default=501, help="seed of the first")
    parser.add_argument("--giving-way", action="store_true", help="leave out the rigid matings")
    arguments = parser.parse_args()
    console = Console(width=150)
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    kinds = ("giving way",) if arguments.giving_way else ("giving way", "rigid")
    found: dict[str, list[Trial]] = {kind: [] for kind in kinds}
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        for kind, trials in found.items():
            for trial in pool.map(partial(_run, compliant=kind != "rigid"), seeds):
                trials.append(trial)
                _save(found)  # an interrupted campaign keeps what it has
                console.print(f"{kind}, seed {trial.seed}: {trial.outcome} {trial.text}")
    for kind, trials in found.items():
        console.print(_table(f"Pins: {kind}", trials))
    console.print(spread(found["giving way"]))
    missed = [line for trial in found["giving way"] for line in _missed(trial)]
    for line in missed:
        console.print(f"MISSED: {line}", style="bold red")
    return 1 if missed else 0


def _save(found: Mapping[str, Sequence[Trial]]) -> None:
    RESULT.parent.mkdir(exist_ok=True)
    rows = {kind: [trial.row() for trial in trials] for kind, trials in found.items()}
    RESULT.write_text(json.dumps(rows, indent=1), encoding="utf-8")


def _run(seed: int, *, compliant: bool) -> Trial:
    pins = PinSettings(engagement_m=(PINS.length_mm + 0.1) * MM, compliant=compliant)
    special: dict[str, Any] = {"pins": PINS, "left": beside(seed)}
    return run_trial(draw_trial(seed), special=special, pins=pins)


def beside(seed: int) -> Array:
    """What is left before the mating (m, rad), shape (6,); tilt and height as the loop does."""
    rng = np.random.default_rng([seed, 13])
    left = rng.uniform(-THRESHOLD, THRESHOLD)
    distance_m, angle = rng.uniform(*BESIDE_MM) * MM, rng.uniform(0.0, 2.0 * np.pi)
    left[:2] = distance_m * np.cos(angle), distance_m * np.sin(angle)
    left[5] = np.deg2rad(rng.uniform(-YAW_DEG, YAW_DEG))
    return left


def _table(title: str, trials: Sequence[Trial]) -> Table:
    table = Table(
        "seed", "beside mm", "k contact", "outcome", "by mm", "gap judged mm", "true gap mm",
        "pin error mm", "lateral peak N", "at the end N", "true peak N", "held N", title=title,
    )  # fmt: skip
    for trial in trials:
        table.add_row(
            str(trial.seed),
            f"{np.hypot(*beside(trial.seed)[:2]) / MM:.3f}",
            f"{trial.stiffness_n_m:.1e}",
            trial.outcome,
            f"{trial.gave_way_mm:.3f}",
            f"{trial.judged_gap_mm:+.3f}",
            f"{trial.true_gap_mm:+.3f}",
            f"{trial.true_pin_error_mm:.3f}",
            f"{trial.peak_lateral_n:.1f}",
            f"{trial.final_lateral_n:.1f}",
            f"{trial.true_peak_n:.1f}",
            f"{trial.final_true_n:.1f}",
        )
    return table


def spread(trials: Sequence[Trial]) -> Table:
    """Median, 95th percentile and greatest value of the figures, and the false verdicts."""
    table = Table("figure", "median", "p95", "max", "limit", title=f"{len(trials)} giving way")
    for key, title, limit in FIGURES:
        values = np.array([getattr(trial, key) for trial in trials])
        # A mating that ended before it held any force has no figure of that.
        values = np.abs(values[np.isfinite(values)])
        if len(values):
            numbers = (*np.percentile(values, [50, 95]), values.max())
            table.add_row(title, *(f"{number:.3g}" for number in numbers), limit)
    table.add_section()
    for title, count in (
        ("called seated, and is not", sum(trial.false_complete for trial in trials)),
        ("not called seated", sum(not trial.complete for trial in trials)),
    ):
        low, high = wilson_bounds(count, len(trials))
        rate = f"{100 * low:.1f} … {100 * high:.1f} %"
        table.add_row(title, f"{count} of {len(trials)}", rate, "", "0")
    return table


def _missed(trial: Trial) -> list[str]:
    missed = []
    if not trial.complete:
        missed.append(f"seed {trial.seed}: {trial.outcome} {trial.text}")
    if trial.false_complete:
        missed.append(f"seed {trial.seed}: false complete")
    if trial.true_peak_n >= LIMIT_N:
        missed.append(f"seed {trial.seed}: true peak {trial.true_peak_n:.1f} N")
    return missed


if __name__ == "__main__":
    sys.exit(main())
