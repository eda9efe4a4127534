"""Whole cycles by touch over many seeds, held against the truth of the contact model.

Run with ``make campaign-insertion``, or by itself: ``python -m benchmarks.insertion.cycle_campaign
-n 30``. Exit code 1 when a part is called inserted that is not.
"""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.insertion.cycles import CycleCell, CycleOutcome, run_cycle
from benchmarks.insertion.farmed import Line, farmed, jobs_of, parser_of, shipped_cell
from benchmarks.insertion.tight_pins import TIGHT_PINS, tight_pin_cell
from benchmarks.insertion.wilson import wilson_bounds
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from fakes.scenes.socket.peaks import ForcePeaks

CELLS = ("pin", "connector")
"""The shipped ones, which are of class A: they have chamfers."""
TRIALS, QUICK_TRIALS = 300, 4
_SEARCH_RATIO = 1.5
"""Multiple of the search force that a 20 ms mean may reach in the search (R3 of the study)."""

Job = tuple[str, int]
"""Cell and seed."""


def main() -> int:
    """Exit code."""
    parser = parser_of(__doc__, "cycles", TRIALS)
    every = (*CELLS, *TIGHT_PINS)
    parser.add_argument("--cells", nargs="+", choices=every, default=every)
    found = parser.parse_args()
    trials = found.n or (QUICK_TRIALS if found.quick else TRIALS)
    jobs = jobs_of(found.cells, found.seed, trials)
    outcomes = farmed(_run, jobs, "cycles", LINE, found)
    by_cell = {
        cell: [one for (name, _), one in zip(jobs, outcomes, strict=True) if name == cell]
        for cell in found.cells
    }
    Console(width=160).print(table(by_cell))
    return 1 if any(one.called_good and not one.seated for one in outcomes) else 0


def _run(job: Job) -> CycleOutcome:
    name, seed = job
    return run_cycle(_cell(name), seed)


def _cell(name: str) -> CycleCell:
    return tight_pin_cell(name) if name in TIGHT_PINS else shipped_cell(name)


def _written(job: Job, outcome: CycleOutcome) -> Mapping[str, Any]:
    return {
        "cell": job[0],
        "seed": outcome.seed,
        "called_good": outcome.called_good,
        "seated": outcome.seated,
        "fault": outcome.fault,
        "search_s": outcome.search_s,
        "cycle_s": outcome.cycle_s,
        "unsolved_share": outcome.unsolved_share,
        "force_n": {phase.value: peaks.force_n for phase, peaks in outcome.peaks.items()},
        "moment_nm": {phase.value: peaks.moment_n_m for phase, peaks in outcome.peaks.items()},
    }


def _read(record: Mapping[str, Any]) -> tuple[Job, CycleOutcome]:
    figures = dict(record)
    cell, forces, moments = (figures.pop(name) for name in ("cell", "force_n", "moment_nm"))
    peaks = {
        CyclePhase(phase): ForcePeaks(_by_window(forces[phase]), _by_window(moments[phase]))
        for phase in forces
    }
    return (cell, int(record["seed"])), CycleOutcome(**figures, peaks=peaks)


def _by_window(figures: Mapping[str, float]) -> dict[int, float]:
    """JSON makes text of a window's number of milliseconds."""
    return {int(window): figure for window, figure in figures.items()}


LINE = Line(_written, _read)


def table(by_cell: dict[str, list[CycleOutcome]]) -> Table:
    """One column for each cell; a rate has the bounds of Wilson, a force its limit."""
    columns = {cell: _column(_cell(cell), outcomes) for cell, outcomes in by_cell.items()}
    shown = Table("", *columns, title="Whole cycles, against the truth")
    for row in zip(*columns.values(), strict=True):
        shown.add_row(row[0][0], *(value for _, value in row))
    return shown


def _column(cell: CycleCell, outcomes: Sequence[CycleOutcome]) -> list[tuple[str, str]]:
    good = [one for one in outcomes if one.called_good and one.seated]
    low, high = wilson_bounds(len(good), len(outcomes))
    false = sum(one.called_good and not one.seated for one in outcomes)
    faults = Counter(one.fault for one in outcomes if one.fault)
    limits = cell.plan.task.limits
    forces = (
        (CyclePhase.SEARCH, _SEARCH_RATIO * limits.search_n),
        (CyclePhase.INSERTION, limits.insertion_n),
        (CyclePhase.VERDICT, limits.insertion_n),
    )
    hardest_n = max(one.peak_n(phase, 3) for one in outcomes for phase in CyclePhase)
    return [
        ("cycles", str(len(outcomes))),
        ("inserted and called so", f"{len(good)} ({100 * low:.1f} to {100 * high:.1f} %)"),
        ("called inserted and are not", str(false)),
        ("faults", ", ".join(f"{n} {fault}" for fault, n in sorted(faults.items())) or "none"),
        ("search, median and p95, s", _times([one.search_s for one in good])),
        ("cycle, median and p95, s", _times([one.cycle_s for one in good])),
        *(
            (
                f"greatest force, {phase.value}, 20 ms mean, N",
                f"{max(one.peak_n(phase, 20) for one in outcomes):.1f} of {limit_n:g}",
            )
            for phase, limit_n in forces
        ),
        ("greatest force, 3 ms mean, N", f"{hardest_n:.1f} of {limits.fault_n:g}"),
        (
            "steps without an equilibrium, greatest share, %",
            f"{100 * max(one.unsolved_share for one in outcomes):.2f}",
        ),
    ]


def _times(values_s: Sequence[float]) -> str:
    if not values_s:
        return "-"
    median, p95 = np.percentile(values_s, [50, 95])
    return f"{median:.0f} and {p95:.0f}"


if __name__ == "__main__":
    sys.exit(main())
