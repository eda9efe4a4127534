"""Every fault of the study's table of signatures, in whole cycles on the pin (R5).

``python -m benchmarks.insertion.fault_campaign -n 20``. Exit code 1 when a part is called inserted
that does not stand at its seat.
"""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.insertion.cycles import CycleOutcome, run_cycle
from benchmarks.insertion.farmed import Line, farmed, jobs_of, parser_of, pin_cell
from benchmarks.insertion.fault_cycles import EXPECTED, CycleFault, injected
from benchmarks.insertion.wilson import wilson_bounds

TRIALS, QUICK_TRIALS = 20, 1

Job = tuple[CycleFault, int]


def main() -> int:
    """Exit code."""
    found = parser_of(__doc__, "cycles", TRIALS).parse_args()
    trials = found.n or (QUICK_TRIALS if found.quick else TRIALS)
    jobs = jobs_of(CycleFault, found.seed, trials)
    outcomes = farmed(_run, jobs, "cycles", LINE, found)
    Console(width=140).print(table(jobs, outcomes))
    return 1 if any(one.called_good and not one.seated for one in outcomes) else 0


def _run(job: Job) -> CycleOutcome:
    fault, seed = job
    return run_cycle(pin_cell(), seed, injected(pin_cell(), fault, seed))


def _written(job: Job, outcome: CycleOutcome) -> Mapping[str, Any]:
    return {
        "injected": job[0].value,
        "seed": job[1],
        "called_good": outcome.called_good,
        "seated": outcome.seated,
        "fault": outcome.fault,
        "height_m": outcome.height_m,
        "cycle_s": outcome.cycle_s,
    }


def _read(record: Mapping[str, Any]) -> tuple[Job, CycleOutcome]:
    figures = dict(record)
    job = CycleFault(figures.pop("injected")), int(record["seed"])
    return job, CycleOutcome(**figures)


LINE = Line(_written, _read)


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
