"""Pegs that are not inserted, fed, pushed and judged in the contact model (R4 of the study).

``python -m benchmarks.insertion.trap_campaign -n 125`` makes 1250 traps on the pin. Each is judged
twice: as the run does, and from its recorded curve. Exit code 1 when a part is called inserted that
is not, by either, or was pushed with more than the insertion may push with.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import isnan, nan
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.insertion.contact_traps import ContactTrap, TrapState, run_contact_trap
from benchmarks.insertion.farmed import Line, exit_code_of, farmed, jobs_of, parser_of, pin_cell
from benchmarks.insertion.wilson import wilson_bounds

TRIALS, QUICK_TRIALS = 125, 2

Job = tuple[TrapState, int]


def main() -> int:
    """Exit code."""
    found = parser_of(__doc__, "traps", TRIALS).parse_args()
    trials = found.n or (QUICK_TRIALS if found.quick else TRIALS)
    traps = farmed(_run, jobs_of(TrapState, found.seed, trials), "traps", LINE, found)
    console = Console(width=140)
    console.print(table(traps))
    named = ((f"{trap.state.value}, seed {trap.seed}", trap.found) for trap in traps)
    return exit_code_of(console, named)


def _run(job: Job) -> ContactTrap:
    state, seed = job
    return run_contact_trap(pin_cell(), state, seed)


def _written(_: Job, trap: ContactTrap) -> Mapping[str, Any]:
    """The result without its curve, which is long."""
    return {name: value for name, value in asdict(trap).items() if name != "curve"}


def _read(record: Mapping[str, Any]) -> tuple[Job, ContactTrap]:
    """Lines that have no force were made before it was judged: it is unknown then."""
    state = TrapState(record["state"])
    known = {"force_n": nan, "limit_n": nan, **record}
    return (state, int(record["seed"])), ContactTrap(**{**known, "state": state, "curve": ""})


LINE = Line(_written, _read)


def table(traps: Sequence[ContactTrap]) -> Table:
    """A row for each state; the bound is Wilson's."""
    shown = Table(
        "state", "traps", "called inserted", "by the curve", "greatest N", "faults", title="Traps"
    )
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
            _greatest(some),
            ", ".join(faults),
        )
    return shown


def _greatest(traps: Sequence[ContactTrap]) -> str:
    known = [trap.force_n for trap in traps if not isnan(trap.force_n)]
    return f"{max(known):.1f} ({len(known)})" if known else "–"


if __name__ == "__main__":
    sys.exit(main())
