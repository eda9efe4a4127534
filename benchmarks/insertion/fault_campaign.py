"""Every fault of the study's table of signatures, in whole cycles on the pin (R5).

``python -m benchmarks.insertion.fault_campaign -n 20``. Exit code 1 when a part is called inserted
that does not stand at its seat.
"""

import sys
from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from benchmarks.insertion.cycles import CycleOutcome, run_cycle
from benchmarks.insertion.farmed import farmed, jobs_of, options, pin_cell
from benchmarks.insertion.fault_cycles import EXPECTED, CycleFault, injected
from benchmarks.insertion.wilson import wilson_bounds

TRIALS, QUICK_TRIALS = 20, 1

Job = tuple[CycleFault, int]


def main() -> int:
    """Exit code."""
    found = options(__doc__, "cycles", TRIALS, QUICK_TRIALS)
    jobs = jobs_of(CycleFault, found)
    outcomes = list(farmed(_run, jobs, "cycles", _plain, found.out))
    Console(width=140).print(table(jobs, outcomes))
    return 1 if any(one.called_good and not one.seated for one in outcomes) else 0


def _run(job: Job) -> CycleOutcome:
    fault, seed = job
    return run_cycle(pin_cell(), seed, injected(pin_cell(), fault, seed))


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
