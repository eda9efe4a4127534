"""What the campaigns of traps and of faults share: options, two processes, lines of JSON."""

import argparse
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from rich.progress import track

from benchmarks.insertion.cycles import CycleCell

WORKERS = 2

Case = TypeVar("Case")
Job = TypeVar("Job")
Result = TypeVar("Result")


@cache
def pin_cell() -> CycleCell:
    """The shipped cell of the pin: read once in each process."""
    return CycleCell.shipped("pin")


def options(text: str | None, what: str, trials: int, quick_trials: int) -> argparse.Namespace:
    """``trials`` of each case, ``seed`` of the first, and ``out``: where lines go, or None."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("--quick", action="store_true", help=f"few {what}")
    parser.add_argument("-n", type=int, help=f"{what} of each case, default {trials}")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first")
    parser.add_argument("--out", type=Path, help="a file for one line of JSON each")
    found = parser.parse_args()
    found.trials = found.n or (quick_trials if found.quick else trials)
    return found


def jobs_of(cases: Iterable[Case], found: argparse.Namespace) -> list[tuple[Case, int]]:
    """One of each case after the other, so that a campaign that is ended early has some of all."""
    named = tuple(cases)
    return [(case, found.seed + n) for n in range(found.trials) for case in named]


def farmed(
    run: Callable[[Job], Result],
    jobs: Sequence[Job],
    what: str,
    plain: Callable[[Job, Result], Mapping[str, Any]],
    out: Path | None,
) -> Iterator[Result]:
    """The result of every job, in order; each is kept in ``out`` as soon as it is there."""
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        found = track(pool.map(run, jobs), what, len(jobs))
        for job, result in zip(jobs, found, strict=True):
            if out is not None:
                with out.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(plain(job, result)) + "\n")
            yield result
