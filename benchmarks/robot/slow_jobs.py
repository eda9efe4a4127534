"""Finds how slow statements may be before the job program no longer keeps its promises.

    python -m benchmarks.robot.slow_jobs --out build/slow-jobs.json

The shipped job files run in the interpreter of ``fakes/robot_jobs`` with 1 to 20 ms a statement,
the real driver at the other end, in a time that does not wait and is exact (``quick_time``).
Measured: period of the reports, begin of a commanded motion, and the time from the cause of a stop,
at any phase of a round, until the motion is told to end: requests over STA and GRD, a PC that falls
silent, and the contact of the PC in the permit loop. Then motions of a PC that is there all the
time, or answers one report late, and that are stopped all the same. The dead time of the controller
comes on top.
"""

import argparse
import json
import logging
import random
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import cast

import numpy as np

from benchmarks.robot.quick_time import QuickTime
from benchmarks.robot.slow_trials import ALIVE, STOPPING, Trial, trial

STATEMENTS_MS = (1.0, 2.0, 5.0, 10.0, 20.0)
TRIALS = 50
Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Row:
    """Milliseconds as median, 99th percentile and greatest."""

    statement_ms: float
    trials: int
    """Number of trials for each cause."""
    report_ms: Three
    begin_ms: Three
    stop_ms: dict[str, Three]
    stopped_alive: dict[str, int]
    """Trials with a PC that is there in which the arm stopped, by cause."""


async def measure(statement_ms: float, trials: int, seed: int) -> Row:
    """One speed of the interpreter."""
    rng, found = random.Random(seed), dict[str, list[Trial]]()
    for cause in (*STOPPING, *ALIVE):
        found[cause] = [await trial(statement_ms / 1000, cause, rng) for _ in range(trials)]
    everything = [one for several in found.values() for one in several]
    return Row(
        statement_ms,
        trials,
        _three([one.report_ms for one in everything]),
        _three([one.begin_ms for one in everything]),
        {cause: _three([_stop_ms(one) for one in found[cause]]) for cause in STOPPING},
        {cause: sum(one.stop_ms is not None for one in found[cause]) for cause in ALIVE},
    )


def _stop_ms(one: Trial) -> float:
    """Endless where nothing stopped the motion."""
    return float("inf") if one.stop_ms is None else one.stop_ms


def _three(values: Sequence[float]) -> Three:
    # A percentile between two values would be none of a motion that was not stopped.
    percentiles = np.percentile(values, [50, 99, 100], method="nearest")
    return cast(Three, tuple(float(value) for value in percentiles))


def table(rows: list[Row]) -> str:
    """The rows as a table of a document."""
    columns = ["ms a statement", "report", "command to motion", *STOPPING, *ALIVE]
    lines = [f"| {' | '.join(columns)} |", "|" + "--:|" * len(columns)]
    for row in rows:
        stops = [row.stop_ms[cause] for cause in STOPPING]
        texts = [" / ".join(f"{one:.0f}" for one in three) for three in (row.begin_ms, *stops)]
        alive = [f"{row.stopped_alive[cause]} of {row.trials}" for cause in ALIVE]
        cells = [f"{row.statement_ms:g}", f"{row.report_ms[0]:.0f}", *texts, *alive]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Measure all speeds and print the table; exit code 1 when a motion outlived its stop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ms", type=float, nargs="+", default=STATEMENTS_MS)
    parser.add_argument("--trials", type=int, default=TRIALS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    # The lost links are what is measured here.
    logging.disable(logging.WARNING)
    try:
        rows = [QuickTime().run(measure(ms, options.trials, options.seed)) for ms in options.ms]
    finally:
        logging.disable(logging.NOTSET)
    print(table(rows))
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    return int(any(np.isinf(three).any() for row in rows for three in row.stop_ms.values()))


if __name__ == "__main__":
    sys.exit(main())
