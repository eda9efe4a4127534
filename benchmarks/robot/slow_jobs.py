"""From which time of a statement on the job program no longer keeps its promises.

    python -m benchmarks.robot.slow_jobs --out build/slow-jobs.json

The shipped job files run in the interpreter of ``fakes/jobs`` with 1 to 20 ms a statement, the real
driver at the other end. Measured: period of the reports, begin of a commanded motion, and the time
from the cause of a stop until the motion is told to end: a request over STA, a PC that falls
silent, and the contact of the PC in the permit loop. The dead time of the controller comes on top.
"""

import argparse
import asyncio
import json
import logging
import time
from collections.abc import Awaitable, Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

from scipy.spatial.transform import RigidTransform

from cellctl.errors.base import CellError
from tests.wire.jobs.job_rig import JobRig, job_rig

STATEMENTS_MS = (1.0, 2.0, 5.0, 10.0, 20.0)
SPEED_M_S = 0.02
WAY_M = 0.1
REPEATS = 3


@dataclass(frozen=True, slots=True)
class Row:
    """Milliseconds; of commands and stops median and greatest."""

    statement_ms: float
    report_ms: float
    begin_ms: tuple[float, float]
    stop_ms: tuple[float, float]
    silence_ms: tuple[float, float]
    contact_ms: tuple[float, float]


async def measure(statement_ms: float) -> Row:
    """One speed of the interpreter. Time-outs of the driver are widened so that none hides it."""
    report_ms = 0.0
    begins: list[float] = []
    stops: dict[str, list[float]] = {"request": [], "silence": [], "contact": []}
    for cause, times in stops.items():
        for _ in range(REPEATS):
            async with job_rig(
                statement_s=statement_ms / 1000,
                stale_s=10.0,
                silence_s=10.0,
                reply_timeout_s=10.0,
                stop_timeout_s=20.0,
                connect_timeout_s=30.0,
            ) as rig:
                await rig.connect()
                report_ms = await _report_ms(rig)
                begin, stop = await _stop(rig, CAUSES[cause])
                begins.append(begin)
                times.append(stop)
    figures = {cause: (median(found), max(found)) for cause, found in stops.items()}
    return Row(
        statement_ms,
        report_ms,
        (median(begins), max(begins)),
        figures["request"],
        figures["silence"],
        figures["contact"],
    )


async def _report_ms(rig: JobRig) -> float:
    times: list[float] = []
    while len(times) < 6:
        await rig.robot._state.wait(lambda _: True, 10.0)
        times.append(time.monotonic())
    return 1000 * (times[-1] - times[0]) / (len(times) - 1)


async def _stop(rig: JobRig, cause: Callable[[JobRig], Awaitable[None]]) -> tuple[float, float]:
    """Milliseconds to the beginning of a motion, and from a cause to the beginning of its end."""
    # The background jobs close the permit loop in their first rounds.
    await rig.robot._state.wait(lambda status: not status.latched, 20.0)
    target = RigidTransform.from_translation([0, 0, WAY_M]) * rig.robot.state(10.0).base_T_flange
    asked_s = time.monotonic()
    move = asyncio.create_task(
        rig.robot.move_linear(target, speed_m_s=SPEED_M_S, acceleration_m_s2=1.0)
    )
    await _until(rig.controller.moving)
    begun_s = time.monotonic()
    await rig.robot._state.wait(lambda status: status.moving, 20.0)
    caused_s = time.monotonic()
    causing = asyncio.ensure_future(cause(rig))
    await _until(lambda: rig.arm.cut_short or not rig.controller.moving())
    stopped_s = time.monotonic()
    await asyncio.gather(causing, return_exceptions=True)
    for wire in rig.wires.values():
        wire.reset()
    try:
        await move
    except CellError:
        return 1000 * (begun_s - asked_s), 1000 * (stopped_s - caused_s)
    return 1000 * (begun_s - asked_s), float("inf")


async def _until(holds: Callable[[], bool]) -> None:
    async with asyncio.timeout(60.0):
        while not holds():  # noqa: ASYNC110  the arm has no event
            await asyncio.sleep(0.001)


async def _request(rig: JobRig) -> None:
    rig.robot._state.request_stop()


async def _silence(rig: JobRig) -> None:
    rig.wires["STA"].back.blocked = True


async def _contact(rig: JobRig) -> None:
    rig.controller.contact_closed = False


CAUSES = {"request": _request, "silence": _silence, "contact": _contact}


def table(rows: list[Row]) -> str:
    """The rows as a table of a document."""
    lines = [
        "| ms a statement | report | command to motion | stop over STA | silent PC | contact |",
        "|--:|--:|--:|--:|--:|--:|",
    ]
    for row in rows:
        pairs = (row.begin_ms, row.stop_ms, row.silence_ms, row.contact_ms)
        texts = [f"{middle:.0f} / {most:.0f}" for middle, most in pairs]
        lines.append(f"| {row.statement_ms:g} | {row.report_ms:.0f} | {' | '.join(texts)} |")
    return "\n".join(lines)


def main() -> None:
    """Measure all speeds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ms", type=float, nargs="+", default=STATEMENTS_MS)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    # The lost links are what is measured here.
    logging.disable(logging.WARNING)
    rows = [asyncio.run(measure(statement_ms)) for statement_ms in options.ms]
    print(table(rows))
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")


if __name__ == "__main__":
    main()
