"""Search strategies side by side on identical seeds, next to the figures of the reference.

Then pegs that are not inserted, which the verdict must not accept. Run with
``make campaign-insertion``, ``QUICK=1`` for few seeds. Exit code 1 when a search says that the peg
has entered where it has not, or the verdict accepts a trap.
"""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.insertion.searches.cases import CASES, SearchCase
from benchmarks.insertion.searches.trials import SearchTrialOutcome, run_search
from benchmarks.insertion.wilson import wilson_bounds
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from tests.rigs.insertion.traps import PegState, TrapOutcome, run_trap

WORKERS = 2
TRIALS, QUICK_TRIALS = 300, 10
NEAR_POINTS = 8.0
"""A rate farther from the reference than this is marked (R6); ten searches scatter by more."""

_TRAP_TASKS = (CASES[4].task, CASES[8].task, CASES[13].task)
"""A tight pin at a stiff and at a soft cell, and the plug."""

Job = tuple[int, SearchName, int, int]
"""Case, strategy, first seed, number of seeds."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few searches")
    parser.add_argument("--seed", type=int, default=1501, help="seed of the first")
    arguments = parser.parse_args()
    trials = QUICK_TRIALS if arguments.quick else TRIALS
    jobs: list[Job] = [
        (index, name, arguments.seed, trials)
        for index, case in enumerate(CASES)
        for name in case.reference
    ]
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        results = list(track(pool.map(_run, jobs), "searches", len(jobs)))
    console = Console(width=160)
    console.print(_table(jobs, results))
    false = sum(one.false_entry for outcomes in results for one in outcomes)
    print(f"{len(jobs) * trials} searches, falsely entered: {false}")
    traps = [
        run_trap(task, state, arguments.seed + n)
        for state in PegState
        for task in _TRAP_TASKS
        for n in range(trials // 5)
    ]
    console.print(_trap_table(traps))
    trapped = sum(one.judgement.inserted for one in traps if one.state is not PegState.INSERTED)
    return 1 if false or trapped else 0


def _run(job: Job) -> list[SearchTrialOutcome]:
    index, name, seed, trials = job
    return [run_search(CASES[index].task, name, seed + n) for n in range(trials)]


def _trap_table(traps: Sequence[TrapOutcome]) -> Table:
    table = Table("state", "trials", "called inserted", "captured by pushes alone", title="Verdict")
    for state in PegState:
        some = [one for one in traps if one.state is state]
        inserted = sum(one.judgement.inserted for one in some)
        captured = sum(one.captured for one in some)
        table.add_row(state.value, str(len(some)), str(inserted), str(captured))
    return table


def _table(jobs: Sequence[Job], results: Sequence[Sequence[SearchTrialOutcome]]) -> Table:
    table = Table("case", "strategy", "found %", "95 % bounds", "reference %", title="Searches")
    for column in ("median s", "p95 s", "touches"):
        table.add_column(column, justify="right")
    for (index, name, *_), outcomes in zip(jobs, results, strict=True):
        table.add_row(*_row(CASES[index], name, outcomes))
    return table


def _row(
    case: SearchCase, name: SearchName, outcomes: Sequence[SearchTrialOutcome]
) -> tuple[str, ...]:
    found = [one for one in outcomes if one.found]
    rate = 100 * len(found) / len(outcomes)
    low, high = wilson_bounds(len(found), len(outcomes))
    reference = case.reference[name]
    far = "" if abs(rate - reference) <= NEAR_POINTS else " (far)"
    times = np.percentile([one.time_s for one in found], [50, 95]) if found else (np.nan, np.nan)
    touches = np.median([one.touches for one in found]) if found else np.nan
    return (
        case.title,
        name.value,
        f"{rate:.1f}",
        f"{100 * low:.1f} to {100 * high:.1f}",
        f"{reference:g}{far}",
        f"{times[0]:.1f}",
        f"{times[1]:.1f}",
        f"{touches:.0f}",
    )


if __name__ == "__main__":
    sys.exit(main())
