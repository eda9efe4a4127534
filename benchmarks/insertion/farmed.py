"""What the campaigns of cycles, traps and faults share: options, processes, lines of JSON.

A campaign that is given a file goes on where it was ended: each result is a line there as soon as
it is known, and what has a line is not run again. Ctrl-C ends it cleanly. Each line has the
software that made it; where a file has lines of several, that is told.
"""

import argparse
import json
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Generic, TypeVar

from rich.console import Console
from rich.progress import track

from benchmarks.insertion.cycles import CycleCell
from cellctl.version import software

WORKERS = 2
_SOFTWARE = "software"

Case = TypeVar("Case")
Job = TypeVar("Job")
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Line(Generic[Job, Result]):
    """How a result is kept."""

    written: Callable[[Job, Result], Mapping[str, Any]]
    """Makes plain data of a result, with what tells its job."""
    read: Callable[[Mapping[str, Any]], tuple[Job, Result]]


@cache
def shipped_cell(name: str) -> CycleCell:
    """Read once in each process."""
    return CycleCell.shipped(name)


def pin_cell() -> CycleCell:
    """The shipped cell of the pin."""
    return shipped_cell("pin")


def exit_code_of(console: Console, found: Iterable[tuple[str, Sequence[str]]]) -> int:
    """Say what is wrong with each result, by its name; 1 where anything is, else 0."""
    wrong = [f"{name}: {words}" for name, several in found for words in several]
    for line in wrong:
        console.print(line)
    return 1 if wrong else 0


def parser_of(text: str | None, what: str, trials: int) -> argparse.ArgumentParser:
    """A parser with the options that all campaigns have."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("--quick", action="store_true", help=f"few {what}")
    parser.add_argument("-n", type=int, help=f"{what} of each case, default {trials}")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first")
    parser.add_argument("--workers", type=int, default=WORKERS, help="processes")
    parser.add_argument("--out", type=Path, help="a file for one line of JSON each, to go on with")
    return parser


def jobs_of(cases: Iterable[Case], seed: int, trials: int) -> list[tuple[Case, int]]:
    """One of each case after the other, so that a campaign that is ended early has some of all."""
    named = tuple(cases)
    return [(case, seed + n) for n in range(trials) for case in named]


def farmed(
    run: Callable[[Job], Result],
    jobs: Sequence[Job],
    what: str,
    line: Line[Job, Result],
    found: argparse.Namespace,
) -> list[Result]:
    """The result of every job, in order; those with a line in ``out`` are taken from there."""
    out: Path | None = found.out
    done = {} if out is None else dict(kept(line, out))
    left = [job for job in jobs if job not in done]
    # SIGTERM ends a campaign as Ctrl-C does: its workers would go on with all that waits.
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    # Ctrl-C reaches the workers, too: they leave it to this process, which cancels what waits.
    pool = ProcessPoolExecutor(
        found.workers,
        mp_context=get_context("spawn"),
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    try:
        results = track(pool.map(run, left), what, len(left))
        for job, result in zip(left, results, strict=True):
            done[job] = result
            if out is not None:
                _keep({**line.written(job, result), _SOFTWARE: software()}, out)
    except KeyboardInterrupt:
        counted = f"ended after {sum(job in done for job in jobs)} of {len(jobs)} {what}"
        sys.exit(counted if out is None else f"{counted}; the same command goes on with {out}")
    finally:
        pool.shutdown(cancel_futures=True)
        signal.signal(signal.SIGTERM, before)
    if out is not None:
        for name, count in Counter(one[_SOFTWARE] for one in _records(out)).items():
            print(f"{out}: {count} {what} by {name}")
    return [done[job] for job in jobs]


def kept(line: Line[Job, Result], out: Path) -> Iterator[tuple[Job, Result]]:
    """What the lines of a file say; a file that is not there has none."""
    for record in _records(out):
        yield line.read({name: value for name, value in record.items() if name != _SOFTWARE})


def _records(out: Path) -> Iterator[dict[str, Any]]:
    text = out.read_text("utf-8") if out.exists() else ""
    for one in text.splitlines():
        try:
            record: dict[str, Any] = json.loads(one)
        except json.JSONDecodeError:
            # Half a line, of a campaign that was killed: that job is run again.
            continue
        yield record


def _keep(record: Mapping[str, Any], out: Path) -> None:
    begun = out.read_bytes() if out.exists() else b""
    with out.open("a", encoding="utf-8") as lines:
        between = "" if not begun or begun.endswith(b"\n") else "\n"
        lines.write(between + json.dumps(record) + "\n")
