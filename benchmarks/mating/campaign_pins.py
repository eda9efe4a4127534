"""Matings onto dowel pins, beside their place by more than the clearance, rigid and giving way.

Run with ``make campaign-mating`` or alone. Prints a table, writes
``runs/campaign-mating-pins.json``; exit code 1 when giving way misses a requirement.
"""

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cellctl.geometry.pose import MM, Array
from cellctl.processes.deck_to_frame.mating.settings import PinSettings
from tests.rigs.mating.cell import THRESHOLD
from tests.rigs.mating.trial import PINS, Trial, draw_trial, run_trial

LIMIT_N = 50.0
WORKERS = 2
RESULT = Path("runs") / "campaign-mating-pins.json"
BESIDE_MM = (0.04, 0.15)
"""Offsets from the clearance to the middle of the chamfer; the measuring loop allows 0.05 per
axis."""
YAW_DEG = 0.008


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=12, help="number of draws, each mated twice")
    parser.add_argument("--seed", type=int, default=501, help="seed of the first")
    arguments = parser.parse_args()
    console = Console(width=150)
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        both = list(pool.map(_pair, seeds))
    console.print(_table(both))
    RESULT.parent.mkdir(exist_ok=True)
    rows = [{"rigid": rigid.row(), "gives way": giving.row()} for rigid, giving in both]
    RESULT.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    missed = [line for _, giving in both for line in _missed(giving)]
    for line in missed:
        console.print(f"MISSED: {line}", style="bold red")
    return 1 if missed else 0


def _pair(seed: int) -> tuple[Trial, Trial]:
    return _run(seed, compliant=False), _run(seed, compliant=True)


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


def _table(both: list[tuple[Trial, Trial]]) -> Table:
    table = Table(
        "seed", "beside mm", "k contact", "rigid", "lateral peak N", "true peak N", "gives way",
        "by mm", "lateral peak N", "lateral at the end N", "true peak N", "final true N",
        title="Pins: rigid and giving way",
    )  # fmt: skip
    for rigid, giving in both:
        table.add_row(
            str(rigid.seed),
            f"{np.hypot(*beside(rigid.seed)[:2]) / MM:.3f}",
            f"{rigid.stiffness_n_m:.1e}",
            rigid.outcome,
            f"{rigid.peak_lateral_n:.1f}",
            f"{rigid.true_peak_n:.1f}",
            giving.outcome,
            f"{giving.gave_way_mm:.3f}",
            f"{giving.peak_lateral_n:.1f}",
            f"{giving.final_lateral_n:.1f}",
            f"{giving.true_peak_n:.1f}",
            f"{giving.final_true_n:.1f}",
        )
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
