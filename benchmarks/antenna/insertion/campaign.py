"""Insertions, good ones and every fault that can be felt, against what is demanded.

Run with ``make campaign-antenna``, or alone with ``--quick``. Prints two tables; exit code 1 when a
demand is not met.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from rich.console import Console
from rich.table import Table

from benchmarks.antenna.insertion.trials import (
    FAULTS,
    GOOD,
    MISSING,
    Fault,
    InsertionOutcome,
    run_insertion,
)
from fakes.world.connector.drawing import D_SUB_15, MICRO_D_15

WORKERS = 2
COUNTS = {MICRO_D_15.name: (300, 40), D_SUB_15.name: (300, 40)}
"""Good insertions of each connector, and insertions with each fault."""
QUICK_COUNTS = {MICRO_D_15.name: (24, 5), D_SUB_15.name: (24, 5)}
BACKED_OUT = ("offset 1.5", "pin bent, 1.5")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few insertions")
    parser.add_argument("--only", nargs="+", choices=list(COUNTS), help="connectors")
    parser.add_argument("--seed", type=int, default=1301, help="seed of the first")
    arguments = parser.parse_args()
    counts = QUICK_COUNTS if arguments.quick else COUNTS
    console = Console(width=150)
    jobs = [
        (name, fault, arguments.seed + n, n % 2 == 1)
        for name in arguments.only or counts
        for fault in (GOOD, *FAULTS, MISSING)
        for n in range(counts[name][fault is not GOOD])
    ]
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        outcomes = list(pool.map(_run, jobs, chunksize=4))
    console.print(_table(outcomes))
    demands = _demands(outcomes)
    table = Table("no.", "what", "demanded", "measured", "", title="Demands")
    for number, what, demanded, measured, met in demands:
        table.add_row(number, what, demanded, measured, "met" if met else "NOT MET")
    console.print(table)
    return 0 if all(met for *_, met in demands) else 1


def _run(job: tuple[str, Fault, int, bool]) -> InsertionOutcome:
    name, fault, seed, in_steps = job
    return run_insertion(fault, seed, in_steps=in_steps, name=name)


def _table(outcomes: Sequence[InsertionOutcome]) -> Table:
    table = Table("pair", "caught", "verdicts", title="Insertions, every other one in steps")
    for column in ("side N", "standing N", "total N", "travel mm"):
        table.add_column(column, justify="right")
    for pair in dict.fromkeys((one.connector, one.fault) for one in outcomes):
        some = [one for one in outcomes if (one.connector, one.fault) == pair]
        verdicts = Counter(one.verdict for one in some)
        table.add_row(
            ", ".join(pair),
            f"{sum(one.caught for one in some)} of {len(some)}",
            ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common()),
            f"{max(one.side_n for one in some):.2f}",
            f"{max(one.standing_n for one in some):.1f}",
            f"{max(one.total_n for one in some):.1f}",
            f"{max(one.travel_m for one in some) * 1e3:.3f}",
        )
    return table


def _demands(outcomes: Sequence[InsertionOutcome]) -> list[tuple[str, str, str, str, bool]]:
    side, standing, total = (
        max(getattr(one, key) for one in outcomes) for key in ("side_n", "standing_n", "total_n")
    )
    faulty = [one for one in outcomes if one.fault not in {GOOD.name, MISSING.name}]
    good = [one for one in outcomes if one.fault == GOOD.name]
    caught, false = sum(one.caught for one in faulty), sum(one.caught for one in good)
    early = [one for one in faulty if not one.fault.startswith("seat")]
    travel_mm = max(one.travel_m for one in early) * 1e3
    back = [one for one in outcomes if one.fault in BACKED_OUT]
    ruined = sum(one.collapsed for one in back)
    return [
        ("B11", "side load of one contact", "≤ 3 N", f"{side:.2f} N", side <= 3),
        ("B11", "one contact that stands", "≤ 20 N", f"{standing:.1f} N", standing <= 20),
        ("B11", "total", "≤ 52 N", f"{total:.1f} N", total <= 52),
        (
            "B12",
            "faults caught",
            "≥ 98 %",
            f"{caught} of {len(faulty)}",
            caught >= 0.98 * len(faulty),
        ),
        ("B12", "good ones refused", "none", f"{false} of {len(good)}", false == 0),
        (
            "B12",
            "from the first early contact to standstill",
            "≤ 0.15 mm",
            f"{travel_mm:.3f} mm",
            travel_mm <= 0.15,
        ),
        (
            "B13",
            "collapsed pins, offset and bend of 1.5 capture radii",
            "none",
            f"{ruined} of {len(back)}",
            ruined == 0 and all(one.caught for one in back),
        ),
    ]


if __name__ == "__main__":
    sys.exit(main())
