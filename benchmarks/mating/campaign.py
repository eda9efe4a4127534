"""Mating campaign: seeded trials over stiffness and stop latency, and injected failures.

Run with ``make campaign-mating``. Prints tables, writes ``runs/campaign-mating.json``; exit code 1
when a requirement is missed.
"""

import argparse
import itertools
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.mating.failures import FAILURES, run_failure
from tests.rigs.mating.trial import Trial, draw_trial, run_trial

LIMIT_N = 50.0
WORKERS = 2
SAVE_EACH = 10
RESULT = Path("runs") / "campaign-mating.json"
STIFFNESS_BINS = (1e5, 3e5, 1e6, 3e6, 1e7)
LATENCY_BINS_MS = (10.0, 50.0, 250.0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=200, help="number of trials")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first trial")
    arguments = parser.parse_args()
    console = Console(width=150)
    seeds = range(arguments.seed, arguments.seed + arguments.n)
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        trials = []
        for trial in pool.map(_seeded, seeds, chunksize=2):
            trials.append(trial)
            if len(trials) % SAVE_EACH == 0:
                _save(trials, [])  # an interrupted campaign keeps what it has
                console.print(f"{len(trials)} of {arguments.n} trials")
        failures = list(pool.map(run_failure, range(len(FAILURES))))
    console.print(_trial_table(trials))
    _print_odd(console, trials)
    console.print(_failure_table(failures))
    _save(trials, failures)
    missed = _missed(trials, failures)
    for line in missed:
        console.print(f"MISSED: {line}", style="bold red")
    console.print(f"{len(trials)} trials, {len(failures)} failures, written to {RESULT}")
    return 1 if missed else 0


def _save(trials: list[Trial], failures: list[Trial]) -> None:
    RESULT.parent.mkdir(exist_ok=True)
    rows = {"trials": [t.row() for t in trials], "failures": [t.row() for t in failures]}
    RESULT.write_text(json.dumps(rows, indent=1), encoding="utf-8")


def _seeded(seed: int) -> Trial:
    return run_trial(draw_trial(seed))


def _trial_table(trials: list[Trial]) -> Table:
    table = Table(
        "k contact N/m", "latency ms", "n", "seated", "false complete", "true peak N med/max",
        "sensed peak N max", "final true N", "slow s", "total s", title="Matings",
    )  # fmt: skip
    for low, high in itertools.pairwise(STIFFNESS_BINS):
        for fast, slow in itertools.pairwise(LATENCY_BINS_MS):
            group = [
                trial
                for trial in trials
                if low <= trial.stiffness_n_m < high and fast <= trial.stop_latency_ms < slow
            ]
            if group:
                table.add_row(f"{low:.0e}…{high:.0e}", f"{fast:.0f}…{slow:.0f}", *_figures(group))
    table.add_section()
    table.add_row("all", "all", *_figures(trials))
    return table


def _figures(group: list[Trial]) -> list[str]:
    done = [trial for trial in group if trial.complete]
    peaks = np.array([trial.true_peak_n for trial in group])
    finals = np.array([trial.final_true_n for trial in done] or [np.nan])
    return [
        str(len(group)),
        str(len(done)),
        str(sum(trial.false_complete for trial in group)),
        f"{np.median(peaks):.1f} / {peaks.max():.1f}",
        f"{max(trial.sensed_peak_n for trial in group):.1f}",
        f"{finals.min():.1f} … {finals.max():.1f}",
        f"{np.nanmedian([trial.slow_s for trial in group]):.1f}",
        f"{np.median([trial.duration_s for trial in group]):.1f}",
    ]


def _failure_table(failures: list[Trial]) -> Table:
    table = Table(
        "injected", "outcome", "wanted", "true peak N", "sensed N", "backed off mm", "standing",
        "note", title="Injected failures",
    )  # fmt: skip
    for trial, failure in zip(failures, FAILURES, strict=True):
        table.add_row(
            failure.name,
            trial.outcome,
            " ".join(failure.outcomes),
            f"{trial.true_peak_n:.1f}",
            f"{trial.sensed_peak_n:.1f}",
            f"{trial.reached_mm - trial.end_travel_mm:.2f}",
            "yes" if trial.standing else "NO",
            failure.note,
        )
    return table


def _print_odd(console: Console, trials: list[Trial]) -> None:
    for trial in trials:
        if not trial.complete or trial.false_complete:
            console.print(
                f"seed {trial.seed}: {trial.outcome}, k {trial.stiffness_n_m:.2e} N/m, latency "
                f"{trial.stop_latency_ms:.0f} ms, true peak {trial.true_peak_n:.1f} N: {trial.text}"
            )


def _missed(trials: list[Trial], failures: list[Trial]) -> list[str]:
    missed = [
        f"seed {trial.seed}: true peak {trial.true_peak_n:.1f} N"
        for trial in trials
        if trial.true_peak_n >= LIMIT_N
    ]
    missed += [f"seed {t.seed}: false complete" for t in trials if t.false_complete]
    for trial, failure in zip(failures, FAILURES, strict=True):
        if trial.outcome not in failure.outcomes:
            missed.append(f"{failure.name}: {trial.outcome} {trial.text}")
        if failure.bounded and trial.true_peak_n >= LIMIT_N:
            missed.append(f"{failure.name}: true peak {trial.true_peak_n:.1f} N")
        if not trial.standing:
            missed.append(f"{failure.name}: the arm still moves")
    return missed


if __name__ == "__main__":
    sys.exit(main())
