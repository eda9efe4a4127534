"""What the page costs the cell, with many readers and broken: `python -m benchmarks.page.clients`.

A whole fake cell with its page stands on this computer. In turn, without and with readers of the
live view, and with a page that is frozen or was killed: the time from a sample on the wire to the
stop request on the wire, of a guard beside it (as in ``make bench-guard``), how late the daemon's
ticks come, how long a command takes to its verdict, and the time for a good part. On a computer
that others share only the ratios say something, and these only over many turns.
"""

import json
import math
import multiprocessing
import os
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.guard.latency import measure
from benchmarks.page.readers import STREAMS_EACH, Heard, add_readers, read
from benchmarks.page.ticks import followed
from benchmarks.page.verdicts import PROGRAMS, commanded
from benchmarks.soak.cell import SoakedCell
from cellctl.hmi.settings import load_settings
from fakes.demo.page import write_settings
from tests.rigs.kept import kept

GRACE_S = 30.0


class Page(StrEnum):
    """What becomes of the page in a turn."""

    QUIET = "no readers"
    READ = "readers"
    FROZEN = "frozen page"
    KILLED = "no page"


@dataclass(frozen=True, slots=True)
class Turn:
    """One turn."""

    page: Page
    readers: int
    guard_ms: tuple[float, ...]
    """p50, p99, p99.9 and the maximum, without what overlaps a stall of the machine."""
    stalled: float
    part_s: tuple[float, ...]
    page_cpu: float
    """Share of one core."""
    page_mib: float
    """Resident memory at its end; NaN for a page that was killed."""
    late_ms: tuple[float, float]
    """Of the snapshots at the readers: p50, p99; NaN without readers."""
    tick_late_ms: tuple[float, float]
    """Of the daemon's ticks, against their period: p50, p99."""
    verdict_ms: tuple[float, float]
    """From a command at the page to the daemon's answer: p50, p99; NaN for a broken page."""
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


@contextmanager
def broken(cell: SoakedCell, settings: Path, page: Page) -> Iterator[None]:
    """The page frozen or gone meanwhile; as it was for any other turn."""
    process = cell.page.process
    if page is Page.FROZEN:
        process.send_signal(signal.SIGSTOP)
    elif page is Page.KILLED:
        process.kill()
        process.wait(GRACE_S)
    try:
        yield
    finally:
        if page is Page.FROZEN:
            process.send_signal(signal.SIGCONT)
        elif page is Page.KILLED:
            cell.page = cell.own.page(settings)
            cell.page.ready()


def turn(
    cell: SoakedCell, settings: Path, page: Page, clients: int, *, seconds: float, parts: int
) -> Turn:
    """Measure with the page so; raises ``RuntimeError`` for a part that is not good."""
    count = clients if page is Page.READ else 0
    url, socket_path = str(cell.page.ready()["url"]), Path(load_settings(settings).socket)
    with (
        readers(url, count) as heard,
        broken(cell, settings, page),
        followed(socket_path) as ticks,
        commanded(url if page in (Page.QUIET, Page.READ) else "") as verdicts,
    ):
        begun_s, used_s = time.monotonic(), _cpu_s(cell.page.process.pid)
        row = measure("guard", "idle", seconds, cell.own.folder)
        times_s = [_part_s(cell) for _ in range(parts)]
        cpu = (_cpu_s(cell.page.process.pid) - used_s) / (time.monotonic() - begun_s)
        mib = math.nan if page is Page.KILLED else kept(cell.page.process.pid).memory_kb / 1024
    (all_of_them,) = heard
    if all_of_them.refused:
        raise RuntimeError(f"not every reader was let in: {all_of_them.refused}")
    if verdicts.odd:
        raise RuntimeError(f"commands had no verdict: {verdicts.odd[:3]}")
    if ticks.ended:
        raise RuntimeError(f"the daemon was not followed to the end: {ticks.ended}")
    return Turn(
        page,
        count,
        row.clean_ms,
        row.stalled,
        tuple(times_s),
        cpu,
        mib,
        _middle_and_late_ms(all_of_them.late_s),
        _middle_and_late_ms(ticks.late_s),
        _middle_and_late_ms(verdicts.took_s),
        os.getloadavg()[0],
    )


def _middle_and_late_ms(times_s: list[float]) -> tuple[float, float]:
    p50, p99 = np.percentile(np.array(times_s or [np.nan]) * 1e3, (50.0, 99.0)).tolist()
    return p50, p99


def _part_s(cell: SoakedCell) -> float:
    begun_s = time.monotonic()
    good, said = cell.part()
    if not good:
        raise RuntimeError(f"a part is not good: {said}")
    return time.monotonic() - begun_s


def _cpu_s(pid: int) -> float:
    # After the name in brackets: user and system time are fields 14 and 15 of proc(5).
    stat = Path(f"/proc/{pid}/stat")
    if not stat.exists():
        return 0.0  # it was killed
    fields = stat.read_text("ascii", "replace").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _cell(value: float, unit: str, without: float) -> str:
    if math.isnan(value):
        return "—"  # nobody was there to measure it
    ratio = "" if math.isnan(without) or not without else f" ({value / without:.2f})"
    return f"{value:.3g} {unit}".rstrip() + ratio


def table(turns: list[Turn]) -> Table:
    """Medians over the turns of each kind; in brackets their ratio to those of no readers."""
    count = max(one.readers for one in turns)
    shown = Table("figure", *(f"{count} readers" if one is Page.READ else one for one in Page))

    def row(name: str, unit: str, of: Any) -> None:
        found = [float(np.median([of(one) for one in turns if one.page is kind])) for kind in Page]
        shown.add_row(name, *(_cell(value, unit, found[0]) for value in found))

    for i, name in enumerate(("p50", "p99", "p99.9", "maximum")):
        row(f"guard, {name}", "ms", lambda one, i=i: one.guard_ms[i])
    if turns[0].part_s:
        row("a part", "s", lambda one: np.median(one.part_s))
    for i, name in enumerate(("p50", "p99")):
        row(f"tick of the daemon late, {name}", "ms", lambda one, i=i: one.tick_late_ms[i])
        row(f"snapshot at a reader, {name}", "ms", lambda one, i=i: one.late_ms[i])
        row(f"command to verdict, {name}", "ms", lambda one, i=i: one.verdict_ms[i])
    row("page, share of a core", "", lambda one: one.page_cpu)
    row("page, resident", "MiB", lambda one: one.page_mib)
    return shown


def main(
    *,
    clients: Annotated[int, typer.Option(min=1, max=60, help="Readers of the live view.")] = 50,
    seconds: Annotated[float, typer.Option(min=2.0, help="Of the guard, each turn.")] = 60.0,
    parts: Annotated[int, typer.Option(min=0, help="Parts in each turn.")] = 3,
    turns: Annotated[int, typer.Option(min=1, help="Of each kind.")] = 2,
    out: Annotated[Path, typer.Option(help="File with every figure.")] = Path(
        "runs/bench-page.json"
    ),
) -> None:
    """Measure in turn, print ratios."""
    console = Console(highlight=False, width=110)
    done: list[Turn] = []
    with tempfile.TemporaryDirectory(prefix="bench-page-") as folder:
        settings, _ = write_settings(Path(folder))
        add_readers(settings, max(clients, PROGRAMS * STREAMS_EACH))
        with SoakedCell.start(Path(folder), page_settings=settings) as cell:
            for number in range(turns):
                # Not always the same first: what drifts must not look like an effect.
                for page in list(Page)[:: -1 if number % 2 else 1]:
                    console.print(f"turn {number + 1}: {page} …")
                    done.append(turn(cell, settings, page, clients, seconds=seconds, parts=parts))
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps([asdict(one) for one in done], indent=2) + "\n", "utf-8")
    console.print(table(done))
    console.print(f"load of the machine {[round(one.load_average, 1) for one in done]}, in {out}")


if __name__ == "__main__":
    typer.run(main)
