"""Pegs that are not inserted, fed, pushed and judged in the contact model (R4 of the study).

``python -m benchmarks.insertion.trap_campaign -n 125`` makes 1000 traps on the pin. Each is judged
twice: as the run does, and from its recorded curve. Exit code 1 when a part is called inserted that
is not.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import cache
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.insertion.contact_traps import ContactTrap, TrapState, run_contact_trap
from benchmarks.insertion.cycles import CycleCell
from benchmarks.insertion.wilson import wilson_bounds

WORKERS = 2
TRIALS, QUICK_TRIALS = 125, 2

Job = tuple[TrapState, int]


def main() -> int:
    """Exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few traps")
    parser.add_argument("-n", type=int, help=f"traps of each state, default {TRIALS}")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first")
    parser.add_argument("--out", type=Path, help="a file for one line of JSON per trap")
    arguments = parser.parse_args()
    trials = arguments.n or (QUICK_TRIALS if arguments.quick else TRIALS)
    # One of each state after the other, so that a campaign that is ended early has some of all.
    jobs = [(state, arguments.seed + n) for n in range(trials) for state in TrapState]
    traps: list[ContactTrap] = []
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        for trap in track(pool.map(_run, jobs), "traps", len(jobs)):
            traps.append(trap)
            if arguments.out is not None:
                with arguments.out.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(_plain(trap)) + "\n")
    Console(width=140).print(table(traps))
    return 1 if any(trap.inserted and not trap.seated for trap in traps) else 0


@cache
def _pin() -> CycleCell:
    return CycleCell.shipped("pin")


def _run(job: Job) -> ContactTrap:
    state, seed = job
    return run_contact_trap(_pin(), state, seed)


def _plain(trap: ContactTrap) -> dict[str, object]:
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
