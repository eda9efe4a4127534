"""Cycles by touch over the wire beside the same cycles without it: do both agree?

``python -m benchmarks.insertion.wire_campaign -n 30`` makes the parts of the first seeds in the
fake cell, with daemon, guard and robot controller, and in ``run_cycle``, on which the other
campaigns rest. A seed draws the same part and the same hole in both. What a folder has already is
not made again. Exit code 1 when a verdict differs, or when a part is called inserted that is not.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.campaign import run_seed
from benchmarks.insertion.cycle_campaign import CELLS
from benchmarks.insertion.cycles import CycleOutcome, run_cycle
from benchmarks.insertion.farmed import shipped_cell
from benchmarks.paired import mean_difference
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from fakes.scenes.socket.part import nominal_fit

TRIALS = 30
"""A tenth of the cycles that ``cycle_campaign`` makes of each cell."""
FIGURES = (
    ("short_mm", "short of the seat, mm"),
    ("force_20_ms_n", "greatest force, 20 ms mean, N"),
    ("force_3_ms_n", "greatest force, 3 ms mean, N"),
)


@dataclass(frozen=True, slots=True)
class Trial:
    """One part, made twice."""

    seed: int
    good_on_wire: bool
    good_without: bool
    seated_on_wire: bool
    wire: dict[str, float]
    """By the keys of ``FIGURES``."""
    without: dict[str, float]

    @property
    def agrees(self) -> bool:
        """Whether both came to the same verdict, and the wire's is true."""
        return self.good_on_wire == self.good_without and (
            self.seated_on_wire or not self.good_on_wire
        )


def main() -> int:
    """Exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=TRIALS, help="seeds of each cell")
    parser.add_argument("--seed", type=int, default=1, help="the first")
    parser.add_argument("--cells", nargs="+", choices=CELLS, default=CELLS)
    parser.add_argument("--out", type=Path, default=Path("runs/insertion-wire"), help="folder")
    found = parser.parse_args()
    console = Console(width=120, highlight=False)
    trials = {
        cell: [
            _try(cell, seed, found.out / cell, console)
            for seed in range(found.seed, found.seed + found.n)
        ]
        for cell in found.cells
    }
    for cell, several in trials.items():
        console.print(table(cell, several))
    differ = [(cell, one) for cell, several in trials.items() for one in several if not one.agrees]
    for cell, one in differ:
        console.print(f"{cell}, seed {one.seed}: {_words(one)}", style="red")
    return 1 if differ else 0


def _try(cell: str, seed: int, out: Path, console: Console) -> Trial:
    kept = out / f"seed-{seed}" / "result.json"
    if kept.exists():
        result: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    else:
        options = ["--process", "peg-in-hole", "--cell", cell]
        result = run_seed(seed, out, options, console)
    return trial(cell, result, run_cycle(shipped_cell(cell), seed))


def trial(cell: str, result: dict[str, Any], cycle: CycleOutcome) -> Trial:
    """``result``: what the demonstration wrote of the same seed."""
    seat_m = nominal_fit(shipped_cell(cell).scenario.fit).depth_m
    without = {
        "short_mm": (seat_m + cycle.height_m) / MM,
        "force_20_ms_n": max(cycle.peak_n(phase, 20) for phase in CyclePhase),
        "force_3_ms_n": max(cycle.peak_n(phase, 3) for phase in CyclePhase),
    }
    return Trial(
        seed=cycle.seed,
        good_on_wire=bool(result.get("result") == "good"),
        good_without=cycle.called_good,
        seated_on_wire=bool(result.get("seated")),
        wire={key: float(result.get(key, np.nan)) for key, _ in FIGURES},
        without=without,
    )


def table(cell: str, trials: Sequence[Trial]) -> Table:
    """Medians and greatest of both, and the mean difference, over the parts that were good."""
    good = [one for one in trials if one.good_on_wire and one.good_without]
    shown = Table(
        f"{cell}: {len(good)} of {len(trials)} good in both",
        "wire, median / max",
        "without, median / max",
        "wire less without",
    )
    for key, title in FIGURES:
        pairs = np.array([(one.without[key], one.wire[key]) for one in good]).reshape(-1, 2)
        if len(pairs) > 1:
            without, wire = (f"{np.median(some):.3f} / {some.max():.3f}" for some in pairs.T)
            mean, sigma = mean_difference(pairs)
            shown.add_row(title, wire, without, f"{mean:+.3f} ± {sigma:.3f}")
    return shown


def _words(one: Trial) -> str:
    said = ["not good", "good"]
    truth = "" if one.seated_on_wire else ", and not seated"
    return f"{said[one.good_on_wire]} over the wire{truth}, {said[one.good_without]} without"


if __name__ == "__main__":
    sys.exit(main())
