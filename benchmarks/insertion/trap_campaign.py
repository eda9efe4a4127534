"""Pegs that are not inserted, fed, pushed and judged in the contact model (R4 of the study).

``python -m benchmarks.insertion.trap_campaign -n 125`` makes 1000 traps on the pin. Each is judged
twice: as the run does, and from its recorded curve. Exit code 1 when a part is called inserted that
is not.
"""

import sys
from collections.abc import Sequence
from dataclasses import asdict

from rich.console import Console
from rich.table import Table

from benchmarks.insertion.contact_traps import ContactTrap, TrapState, run_contact_trap
from benchmarks.insertion.farmed import farmed, jobs_of, options, pin_cell
from benchmarks.insertion.wilson import wilson_bounds

TRIALS, QUICK_TRIALS = 125, 2

Job = tuple[TrapState, int]


def main() -> int:
    """Exit code."""
    found = options(__doc__, "traps", TRIALS, QUICK_TRIALS)
    jobs = jobs_of(TrapState, found)
    traps = list(farmed(_run, jobs, "traps", _plain, found.out))
    Console(width=140).print(table(traps))
    return 1 if any(trap.inserted and not trap.seated for trap in traps) else 0


def _run(job: Job) -> ContactTrap:
    state, seed = job
    return run_contact_trap(pin_cell(), state, seed)


def _plain(_: Job, trap: ContactTrap) -> dict[str, object]:
    """Without the curve, which is long."""
    return {name: value for name, value in asdict(trap).items() if name != "curve"}


def table(traps: Sequence[ContactTrap]) -> Table:
    """A row for each state; the bound is Wilson's."""
    shown = Table("state", "traps", "called inserted", "by the curve", "faults", title="Traps")
    for state in TrapState:
        some = [trap for trap in traps if trap.state is state]
        if not some:
            continue
        inserted = sum(trap.inserted for trap in some)
        _, high = wilson_bounds(inserted, len(some))
        faults = sorted({trap.fault for trap in some if trap.fault})
        shown.add_row(
            state.value,
            str(len(some)),
            f"{inserted} (at most {100 * high:.1f} %)",
            str(sum(trap.by_curve == "inserted" for trap in some)),
            ", ".join(faults),
        )
    return shown


if __name__ == "__main__":
    sys.exit(main())
