"""Every fault of the study's table of signatures, in whole cycles on the pin (R5).

``python -m benchmarks.insertion.fault_campaign -n 20``. Exit code 1 when a part is called inserted
that does not stand at its seat.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.insertion.cycles import CycleCell, CycleOutcome, run_cycle
from benchmarks.insertion.fault_cycles import EXPECTED, CycleFault, injected
from benchmarks.insertion.wilson import wilson_bounds

WORKERS = 2
TRIALS, QUICK_TRIALS = 20, 1

Job = tuple[CycleFault, int]


def main() -> int:
    """Exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one cycle of each fault")
    parser.add_argument("-n", type=int, help=f"cycles of each fault, default {TRIALS}")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first")
    parser.add_argument("--out", type=Path, help="a file for one line of JSON per cycle")
    arguments = parser.parse_args()
    trials = arguments.n or (QUICK_TRIALS if arguments.quick else TRIALS)
    jobs = [(fault, arguments.seed + n) for n in range(trials) for fault in CycleFault]
    outcomes: list[CycleOutcome] = []
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        for job, outcome in zip(
            jobs, track(pool.map(_run, jobs), "cycles", len(jobs)), strict=True
        ):
            outcomes.append(outcome)
            if arguments.out is not None:
                with arguments.out.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(_plain(job, outcome)) + "\n")
    Console(width=140).print(table(jobs, outcomes))
    return 1 if any(one.called_good and not one.seated for one in outcomes) else 0


@cache
def _pin() -> CycleCell:
    return CycleCell.shipped("pin")


def _run(job: Job) -> CycleOutcome:
    fault, seed = job
    return run_cycle(_pin(), seed, injected(_pin(), fault, seed))


def _plain(job: Job, outcome: CycleOutcome) -> dict[str, object]:
    return {
        "injected": job[0].value,
        "seed": job[1],
        "called_good": outcome.called_good,
        "seated": outcome.seated,
        "fault": outcome.fault,
        "height_mm": 1e3 * outcome.height_m,
        "cycle_s": outcome.cycle_s,
    }


def table(jobs: Sequence[Job], outcomes: Sequence[CycleOutcome]) -> Table:
    """A row for each fault; the bound is Wilson's."""
    shown = Table(
        "fault", "cycles", "right fault", "at least", "inserted in spite of it", "all faults",
        title="Faults",
    )  # fmt: skip
    for fault in CycleFault:
        some = [one for (name, _), one in zip(jobs, outcomes, strict=True) if name is fault]
        if not some:
            continue
        overcome = sum(one.called_good and one.seated for one in some)
        right = sum(one.fault in EXPECTED[fault] for one in some)
        low, _ = wilson_bounds(right, len(some))
        counted = Counter(one.fault or "none" for one in some)
        words = ", ".join(f"{count} {name}" for name, count in sorted(counted.items()))
        shown.add_row(
            fault.value, str(len(some)), str(right), f"{100 * low:.0f} %", str(overcome), words
        )
    return shown


if __name__ == "__main__":
    sys.exit(main())
