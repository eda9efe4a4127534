"""``make bench-antenna-vision``: connectors in rendered images against truth.

Every row says what is demanded and what was measured, by the default method and, on the same
images, by the paper's. The exit code is 1 where the default misses a demand.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from rich.console import Console

from benchmarks.antenna.vision.bench import Bench, clean_rows, poor_rows
from benchmarks.antenna.vision.timing import time_rows


def main() -> int:
    """Print the table; 1 when a demand was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=80, help="images of most rows")
    parser.add_argument("--only", nargs="*", default=[], help="rows, as B1 B6")
    chosen = parser.parse_args()
    # The processes are not forked, because OpenCV's threads do not survive a fork.
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        bench = Bench(pool, chosen.n)
        for number, rows in _rows(bench).items():
            if number in chosen.only or not chosen.only:
                for row in rows:
                    row()
    Console(width=200).print(bench.report.table)
    return 1 if bench.report.missed else 0


def _rows(bench: Bench) -> Mapping[str, Sequence[Callable[[], None]]]:
    return {
        "B1": [lambda: clean_rows(bench)],
        "B2": [lambda: poor_rows(bench)],
        "B3": [bench.missing, bench.blocked],
        "B4": [bench.bent],
        "B5": [bench.wrong],
        "B6": [bench.covariance],
        "B15": [lambda: time_rows(bench.report)],
    }


if __name__ == "__main__":
    sys.exit(main())
