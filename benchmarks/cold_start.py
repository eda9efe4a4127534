"""How long the daemon of the fake cell takes to be ready: `python -m benchmarks.cold_start`.

The processors' time beside it tells a slow start from a busy PC.
"""

import os
import signal
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Annotated

import typer

from tests.rigs.whole_cell.own_cell import OwnCell, Program

BOUND_S = 3.0
_CACHES = Path("/proc/sys/vm/drop_caches")
_TICKS_A_SECOND = os.sysconf("SC_CLK_TCK")
_USER, _SYSTEM = 11, 12
"""Fields of ``/proc/PID/stat`` behind the name of the program, in ticks (proc(5))."""


@dataclass(frozen=True, slots=True)
class Start:
    """One start."""

    ready_s: float
    processors_s: float
    """Time of the processors that the daemon and its children have used by then."""


def main(
    starts: Annotated[int, typer.Option("-n", min=1, help="How often.")] = 10,
    *,
    from_disk: Annotated[
        bool, typer.Option(help="Empty the file cache before each start; wants root.")
    ] = False,
) -> None:
    """Start and end the daemon; exit code 1 unless the median start is below 3 s."""
    with tempfile.TemporaryDirectory() as folder:
        own = OwnCell.make(Path(folder))
        try:
            own.fake().ready()
            seen = [_start(own, from_disk=from_disk) for _ in range(starts)]
        finally:
            own.kill_all()
    ready = [one.ready_s for one in seen]
    used = [one.processors_s for one in seen]
    typer.echo(
        f"ready after {median(ready):.2f} s (median of {starts}), {max(ready):.2f} s at most"
    )
    typer.echo(f"processors' time by then {median(used):.2f} s, {max(used):.2f} s at most")
    if median(ready) >= BOUND_S:
        raise typer.Exit(1)


def _start(own: OwnCell, *, from_disk: bool) -> Start:
    if from_disk:
        os.sync()
        _CACHES.write_text("3", "ascii")
    begun_s = time.monotonic()
    daemon = own.daemon()
    daemon.ready()
    start = Start(time.monotonic() - begun_s, processors_s(daemon))
    if code := daemon.interrupt(signal.SIGTERM):
        raise RuntimeError(f"the daemon ended with {code}: {daemon.stderr[-500:]}")
    return start


def processors_s(daemon: Program) -> float:
    """Time of the processors that a program and its descendants have used."""
    ticks = 0
    for number in daemon.descendants():
        try:
            fields = Path(f"/proc/{number}/stat").read_text("ascii").rpartition(")")[2].split()
        except OSError:
            continue  # a helper that has ended
        ticks += int(fields[_USER]) + int(fields[_SYSTEM])
    return ticks / _TICKS_A_SECOND


if __name__ == "__main__":
    typer.run(main)
