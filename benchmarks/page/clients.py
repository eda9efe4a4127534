"""What readers of the page cost the cell: `python -m benchmarks.page.clients`.

A whole fake cell with its page stands on this computer. Without and with readers of the live view,
in turn: the time from a sample on the wire to the stop request on the wire, of a guard beside it
(as in ``make bench-guard``), and the time for a good part. On a computer that others share only the
ratios say something, and these only over many turns.
"""

import json
import multiprocessing
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.guard.latency import measure
from benchmarks.page.readers import Heard, add_readers, read
from benchmarks.soak.cell import SoakedCell
from fakes.demo.page import write_settings

GRACE_S = 30.0


@dataclass(frozen=True, slots=True)
class Turn:
    """One turn with so many readers."""

    readers: int
    guard_ms: tuple[float, ...]
    """p50, p99, p99.9 and the maximum, without what overlaps a stall of the machine."""
    stalled: float
    part_s: tuple[float, ...]
    page_cpu: float
    """Share of one core."""
    late_ms: tuple[float, float]
    """Of the snapshots at the readers: p50, p99; NaN without readers."""
    load_average: float


@contextmanager
def readers(url: str, count: int) -> Iterator[list[Heard]]:
    """So many readers meanwhile; what they heard, once they have ended."""
    found: list[Heard] = []
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=read, args=(theirs, url, count))
    process.start()
    try:
        _answer(ours)
        yield found
        ours.send("end")
        found.append(_answer(ours))
    finally:
        process.join(GRACE_S)
        if process.exitcode is None:
            process.terminate()


def _answer(pipe: Any) -> Any:
    if not pipe.poll(GRACE_S):
        raise TimeoutError("the readers do not answer")
    return pipe.recv()


def turn(cell: SoakedCell, url: str, count: int, seconds: float, parts: int) -> Turn:
    """Measure with so many readers; raises ``RuntimeError`` for a part that is not good."""
    with readers(url, count) as heard:
        begun_s, used_s = time.monotonic(), _cpu_s(cell.page.process.pid)
        row = measure("guard", "idle", seconds, cell.own.folder)
        times_s = [_part_s(cell) for _ in range(parts)]
        cpu = (_cpu_s(cell.page.process.pid) - used_s) / (time.monotonic() - begun_s)
    (all_of_them,) = heard
    if all_of_them.refused:
        raise RuntimeError(f"not every reader was let in: {all_of_them.refused}")
    late_ms = np.array(all_of_them.late_s or [np.nan]) * 1e3
    p50, p99 = np.percentile(late_ms, (50.0, 99.0)).tolist()
    return Turn(
        count, row.clean_ms, row.stalled, tuple(times_s), cpu, (p50, p99), os.getloadavg()[0]
    )


def _part_s(cell: SoakedCell) -> float:
    begun_s = time.monotonic()
    number = len(cell.cycles) + 1
    good, said = cell.part(number)
    if not good:
        raise RuntimeError(f"part {number} is not good: {said}")
    return time.monotonic() - begun_s


def _cpu_s(pid: int) -> float:
    # After the name in brackets: user and system time are fields 14 and 15 of proc(5).
    fields = Path(f"/proc/{pid}/stat").read_text("ascii", "replace").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def table(turns: list[Turn]) -> Table:
    """Without and with readers, and the ratio of the medians over the turns."""
    shown = Table(
        "figure", "no readers", f"{turns[-1].readers or turns[1].readers} readers", "ratio"
    )
    without = [one for one in turns if not one.readers]
    reading = [one for one in turns if one.readers]

    def row(name: str, unit: str, of: Any) -> None:
        first, second = (float(np.median([of(one) for one in ones])) for ones in (without, reading))
        shown.add_row(name, f"{first:.3g} {unit}", f"{second:.3g} {unit}", f"{second / first:.2f}")

    for i, name in enumerate(("p50", "p99", "p99.9", "maximum")):
        row(f"guard, {name}", "ms", lambda one, i=i: one.guard_ms[i])
    if turns[0].part_s:
        row("a part", "s", lambda one: np.median(one.part_s))
    row("page, share of a core", "", lambda one: one.page_cpu)
    late = [one.late_ms for one in reading]
    p50, p99 = np.median(np.array(late), axis=0)
    shown.add_row("snapshot at a reader, p50 and p99", "", f"{p50:.1f} and {p99:.1f} ms", "")
    return shown


def main(
    *,
    clients: Annotated[int, typer.Option(min=1, max=60, help="Readers of the live view.")] = 50,
    seconds: Annotated[float, typer.Option(min=2.0, help="Of the guard, each turn.")] = 60.0,
    parts: Annotated[int, typer.Option(min=0, help="Parts in each turn.")] = 3,
    turns: Annotated[int, typer.Option(min=1, help="With and without readers.")] = 2,
    out: Annotated[Path, typer.Option(help="File with every figure.")] = Path(
        "runs/bench-page.json"
    ),
) -> None:
    """Measure in turn, print ratios."""
    console = Console(highlight=False, width=110)
    done: list[Turn] = []
    with tempfile.TemporaryDirectory(prefix="bench-page-") as folder:
        settings, _ = write_settings(Path(folder))
        add_readers(settings, clients)
        with SoakedCell.start(Path(folder), page_settings=settings) as cell:
            url = str(cell.page.ready()["url"])
            for number in range(turns):
                # Not always the same first: what drifts must not look like an effect.
                for count in (0, clients) if number % 2 == 0 else (clients, 0):
                    console.print(f"turn {number + 1}: {count} readers …")
                    done.append(turn(cell, url, count, seconds, parts))
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps([asdict(one) for one in done], indent=2) + "\n", "utf-8")
    console.print(table(done))
    console.print(f"load of the machine {[round(one.load_average, 1) for one in done]}, in {out}")


if __name__ == "__main__":
    typer.run(main)
