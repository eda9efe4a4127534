"""Times from the sample on the wire to the stop request on the wire: ``make bench-guard``.

Box and robot are processes of their own that stamp with the same monotonic clock; every frame
under force gives one stop request. Measured for the guard process and for the plain design, idle,
under vision load, and under vision load with calls that keep the interpreter lock. A monitor
records when the machine itself stood still; "clean" leaves out what overlaps that. Slow answers
overlap more often, so leaving out flatters the slow design, not the fast one.
"""

import argparse
import json
import multiprocessing
import os
import platform
import socket
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.guard import designs, peers
from benchmarks.guard.loads import bomb_ms
from benchmarks.guard.stalls import StallMonitor, Stalls, touched

LOADS = ("idle", "vision", "gil")
DESIGNS: dict[str, Callable[..., None]] = {
    "guard": designs.guard_process,
    "plain": designs.plain,
}
Times = NDArray[np.float64]

WARM_UP_S = 1.0
GRACE_S = 0.5
"""What is answered later than this after the end counts as unanswered."""
PERCENTILES = (50.0, 99.0, 99.9, 100.0)
LIMIT_MS = 1.0
FACTORS = {"vision": 4.0, "gil": 20.0}
MOST_STALLED = 0.05


@dataclass(frozen=True, slots=True)
class Row:
    """One design under one load. Latencies in ms at p50, p99, p99.9 and the maximum."""

    load: str
    design: str
    seconds: float
    degraded: str
    samples: int = 0
    unanswered: int = 0
    """Frames less stop requests; anything but 0 also makes the latencies void."""
    clean_ms: tuple[float, ...] = ()
    raw_ms: tuple[float, ...] = ()
    stalled: float = 0.0
    """Share of samples that overlap a stall of the machine."""
    stalls: int = 0
    worst_stall_ms: float = 0.0


def measure(design: str, load: str, seconds: float, folder: Path) -> Row:
    """Run one design under one load."""
    context = multiprocessing.get_context("spawn")
    box, box_end = context.Pipe()
    robot, robot_end = context.Pipe()
    subject, subject_end = context.Pipe()
    guard_port = _free_port()
    processes = [context.Process(target=peers.box, args=(box_end,))]
    processes[0].start()
    arguments = (subject_end, _receive(box), guard_port, load)
    processes.append(context.Process(target=DESIGNS[design], args=arguments))
    processes.append(context.Process(target=peers.robot, args=(robot_end, guard_port)))
    for process in processes[1:]:
        process.start()
    try:
        degraded = _receive(subject)
        monitor = StallMonitor(folder)
        box.send("on")
        time.sleep(seconds + WARM_UP_S)
        box.send("off")
        time.sleep(GRACE_S)
        stalls = monitor.stop()
        box.send("end")
        robot.send("end")
        sent_s, stopped_s = _receive(box), _receive(robot)
        subject.send("end")
        for process in processes:
            process.join(15)
    finally:
        for process in processes:
            if process.exitcode is None:
                process.terminate()
    return evaluate(Row(load, design, seconds, degraded), sent_s, stopped_s, stalls)


def evaluate(row: Row, sent_s: Times, stopped_s: Times, stalls: Stalls) -> Row:
    """The k-th stop request answers the k-th frame under force."""
    count = min(len(sent_s), len(stopped_s))
    begin_s, end_s = sent_s[:count], stopped_s[:count]
    warm = begin_s > sent_s[0] + WARM_UP_S
    begin_s, end_s = begin_s[warm], end_s[warm]
    latency_ms = (end_s - begin_s) * 1e3
    stalled = touched(begin_s, end_s, stalls)
    return replace(
        row,
        samples=len(latency_ms),
        unanswered=len(sent_s) - len(stopped_s),
        clean_ms=_percentiles(latency_ms[~stalled]),
        raw_ms=_percentiles(latency_ms),
        stalled=float(stalled.mean()),
        stalls=len(stalls),
        worst_stall_ms=float(np.ptp(stalls, axis=1).max() * 1e3) if len(stalls) else 0.0,
    )


def verdicts(rows: list[Row]) -> list[tuple[str, bool | None]]:
    """The requirements and whether they hold; None where stalls left too little to judge."""
    by = {(row.load, row.design): row for row in rows}
    found: list[tuple[str, bool | None]] = []
    for load, factor in FACTORS.items():
        guard, plain = by.get((load, "guard")), by.get((load, "plain"))
        if guard is not None:
            tail = guard.clean_ms[2]
            held = None if guard.stalled > MOST_STALLED and tail >= LIMIT_MS else tail < LIMIT_MS
            words = f"{load}: clean p99.9 {tail:.2f} ms, must be below {LIMIT_MS:g} ms"
            found.append((words, held and guard.unanswered == 0))
        if guard is not None and plain is not None:
            ratio = plain.clean_ms[2] / guard.clean_ms[2]
            words = f"{load}: {ratio:.1f} × below the plain design, must be {factor:g} ×"
            found.append((words, ratio >= factor))
    return found


def table(rows: list[Row]) -> str:
    """The table that the terminal shows."""
    head = (
        f"{'load':8}{'design':8}{'samples':>8} │"
        f"{'clean p50':>10}{'p99':>10}{'p99.9':>10}{'max':>9} │"
        f"{'raw p99.9':>10}{'max':>9} │{'stalled':>8}{'worst':>9}"
    )
    lines = [head, "─" * len(head)]
    for row in rows:
        p50, p99, p999, most = row.clean_ms
        note = f"  {row.unanswered} unanswered" if row.unanswered else ""
        note += f"  degraded: {row.degraded}" if row.degraded else ""
        lines.append(
            f"{row.load:8}{row.design:8}{row.samples:8d} │{p50:10.3f}{p99:10.3f}{p999:10.3f}"
            f"{most:9.2f} │{row.raw_ms[2]:10.3f}{row.raw_ms[3]:9.2f} │{row.stalled:8.2%}"
            f"{row.worst_stall_ms:6.1f} ms{note}"
        )
    return "\n".join(lines)


def main() -> int:
    """Measure, print, write; 1 when a requirement is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0, help="of each measurement")
    parser.add_argument("--loads", nargs="+", choices=LOADS, default=list(LOADS))
    parser.add_argument("--designs", nargs="+", choices=list(DESIGNS), default=list(DESIGNS))
    parser.add_argument("--out", type=Path, default=Path("runs/bench-guard.json"))
    options = parser.parse_args()
    rows: list[Row] = []
    bomb = bomb_ms()
    with tempfile.TemporaryDirectory(prefix="bench-guard-") as folder:
        for load in options.loads:
            for design in options.designs:
                print(f"{load}, {design}: {options.seconds:g} s …", file=sys.stderr, flush=True)
                rows.append(measure(design, load, options.seconds, Path(folder)))
    judged = verdicts(rows)
    print(f"latency in ms, 1 kHz; a call that keeps the interpreter lock takes {bomb:.0f} ms")
    print(table(rows))
    words = {True: "reached", False: "MISSED", None: "inconclusive: the machine stalled too often"}
    for requirement, held in judged:
        print(f"{words[held]:9} {requirement}")
    _write(options.out, rows, judged, bomb)
    return int(any(held is False for _, held in judged))


def _write(path: Path, rows: list[Row], judged: list[tuple[str, bool | None]], bomb: float) -> None:
    machine = {
        "kernel": platform.release(),
        "python": platform.python_version(),
        "processors": os.cpu_count(),
        "load_average": os.getloadavg(),
        "bomb_ms": bomb,
    }
    content: dict[str, Any] = {
        "machine": machine,
        "rows": [asdict(row) for row in rows],
        "requirements": [{"text": text, "held": held} for text, held in judged],
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    print(f"written to {path}")


def _percentiles(latency_ms: Times) -> tuple[float, ...]:
    if len(latency_ms) == 0:
        return (float("nan"),) * len(PERCENTILES)
    return tuple(float(value) for value in np.percentile(latency_ms, PERCENTILES))


def _receive(pipe: Any) -> Any:
    if not pipe.poll(30):
        raise TimeoutError("a process of the benchmark did not answer")
    return pipe.recv()


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


if __name__ == "__main__":
    sys.exit(main())
