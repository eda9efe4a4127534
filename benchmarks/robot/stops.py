"""Every way to stop an arm, from the decision to the arm's order to brake: ``make bench-robot``.

    python -m benchmarks.robot.stops --repeats 30 --out build/stops.json

Three ways to a controller that runs the shipped jobs: the stop of the daemon over STA, that of the
guard over GRD, and a digital output of the PC in the permit loop, which no program of the
controller has to read; and the guard's stop of a collaborative arm over RPC. Then the same with a
PC that says nothing any more. The dead time of a controller and its braking come on top of every
row: they are measured on site by procedure 107.
"""

import argparse
import asyncio
import contextlib
import json
import logging
import os
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.robot.stop_methods import WAYS, Way
from cellctl.errors.base import CellError

WAY_M, SPEED_M_S = 0.1, 0.02
FULL_SPEED_S = 0.3
SPREAD_S = 0.037
"""Stops of one way come at different places of a round of the job."""


@dataclass(frozen=True, slots=True)
class StopRow:
    """Milliseconds from the decision to the order to brake."""

    way: str
    depends_on: str
    count: int
    p50_ms: float
    p99_ms: float
    max_ms: float
    bound_ms: float
    """What the parts of this way add up to at 1 ms a statement."""

    @property
    def kept(self) -> bool:
        """Whether the greatest of all lies within."""
        return self.max_ms <= self.bound_ms


async def once(way: Way, turn: int) -> float:
    """Milliseconds from the decision to the order to brake, of one motion."""
    async with way() as ready:
        ordered_s: list[float] = []
        brake = ready.arm.stop

        def noted(time_s: float, *, latency_s: float | None = None) -> None:
            ordered_s.append(time.monotonic())
            brake(time_s, latency_s=latency_s)

        ready.arm.stop = noted  # type: ignore[method-assign]
        up = RigidTransform.from_translation([0.0, 0.0, WAY_M])
        job = asyncio.create_task(
            ready.robot.move_linear(
                up * ready.robot.state(10.0).base_T_flange,
                speed_m_s=SPEED_M_S,
                acceleration_m_s2=1.0,
            )
        )
        async with asyncio.timeout(30.0):
            while not ready.moving():  # noqa: ASYNC110  the arm has no event
                await asyncio.sleep(0.001)
            # Anywhere in a round of the job, and at full speed.
            await asyncio.sleep(FULL_SPEED_S + SPREAD_S * turn)
            decided_s = time.monotonic()
            await ready.stop()
            while not ordered_s:  # noqa: ASYNC110  likewise
                await asyncio.sleep(0.001)
            # A driver that is cancelled would ask for a stop of its own over the silent wire.
            with contextlib.suppress(CellError):
                await job
            if ready.decided_s is not None:
                decided_s = ready.decided_s()
        return 1000.0 * (ordered_s[0] - decided_s)


async def measure(names: list[str], repeats: int) -> list[StopRow]:
    """All ways in turn, so that whatever the PC does beside meets all of them alike."""
    times: dict[str, list[float]] = {name: [] for name in names}
    for turn in range(repeats):
        for name in names:
            times[name].append(await once(WAYS[name][1], turn % 10))
    return [_row(name, found) for name, found in times.items()]


def _row(name: str, times_ms: list[float]) -> StopRow:
    depends_on, _, bound_ms = WAYS[name]
    p50_ms, p99_ms, max_ms = np.percentile(times_ms, [50, 99, 100]).tolist()
    return StopRow(name, depends_on, len(times_ms), p50_ms, p99_ms, max_ms, bound_ms)


def table(rows: list[StopRow]) -> str:
    """The rows as a table of a document."""
    lines = [
        "| way | in the controller it needs | stops | p50, ms | p99, ms | max, ms | bound, ms |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    lines += [
        f"| {row.way} | {row.depends_on} | {row.count} "
        f"| {row.p50_ms:.1f} | {row.p99_ms:.1f} | {row.max_ms:.1f} "
        f"| {row.bound_ms:.0f}{'' if row.kept else ' **exceeded**'} |"
        for row in rows
    ]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Print the table; exit code 1 when a bound is exceeded."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=30)
    parser.add_argument("--way", choices=sorted(WAYS), nargs="+", default=list(WAYS))
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    # The lost links are what is measured here.
    logging.disable(logging.WARNING)
    load = os.getloadavg()[0]
    try:
        rows = asyncio.run(measure(options.way, options.repeats))
    finally:
        logging.disable(logging.NOTSET)
    print(table(rows))
    print(f"load of this PC: {load:.1f} before, {os.getloadavg()[0]:.1f} after")
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    return 0 if all(row.kept for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
