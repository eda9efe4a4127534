"""Streamed motion of a collaborative arm: period, jitter, late and lost ticks, and refusals."""

import sys
import time
from itertools import pairwise

from scipy.spatial.transform import RigidTransform

from benchmarks.robot.rpc_bench import Bench, Figures, percentiles, rearm
from cellctl.errors.base import CellError
from cellctl.errors.robot import SetpointRefused, TargetOutOfBounds
from cellctl.interfaces.streaming_robot import StreamReport
from drivers.robot.siasun_rpc.driver import SiasunRpcRobot

MOST_ENDS = 10
BEFORE_REFUSAL = 5
"""Setpoints that are followed before one that is refused."""
TOO_FAR = 3
"""Steps at once."""


async def streamed(bench: Bench, period_ms: int, ticks: int) -> Figures:
    """Setpoints straight down and up again, as fast as the arm may go by its limits. A stream that
    ends early is followed by another one until there were enough ticks."""
    jitter_s: list[float] = []
    total = {"ticks": 0.0, "late": 0.0, "lost": 0.0, "ended early": 0.0}
    async with bench.robot(period_ms) as robot:
        while total["ticks"] < ticks and total["ended early"] < MOST_ENDS:
            reports: list[StreamReport] = []
            try:
                await _stream(robot, round(ticks - total["ticks"]), reports)
            except CellError as fault:
                print(f"a stream of {period_ms} ms ended early: {fault}", file=sys.stderr)
                total["ended early"] += 1
                await rearm(robot)
            # Where ticks were lost the pause is longer by intent.
            jitter_s += [
                abs(after.time_s - before.time_s - period_ms / 1000)
                for before, after in pairwise(reports)
                if after.tick == before.tick + 1
            ]
            if reports:
                total["ticks"] += reports[-1].tick
                total["late"] += reports[-1].late
                total["lost"] += reports[-1].lost
    return percentiles(jitter_s) | total


async def _stream(robot: SiasunRpcRobot, ticks: int, reports: list[StreamReport]) -> None:
    limits = robot.stream_offer().limits
    async with robot.stream(limits) as stream:
        start, way = stream.report.base_T_flange, int(limits.travel_m / limits.step_m) // 2
        while stream.report.tick < ticks:
            step = way - abs(len(reports) % (2 * way) - way)
            reports.append(await stream.advance(_down(step * limits.step_m) * start))


async def refused(bench: Bench, period_ms: int, repeats: int) -> dict[str, Figures]:
    """Setpoints that must be refused, by how: one that is too far for the driver's bounds, which
    is not sent, and one that the controller answers with -1. How many of them ended their stream
    as refused, and the time until that was told, with the arm standing."""
    figures: dict[str, Figures] = {}
    async with bench.robot(period_ms) as robot:
        for name in ("too far", "answered with -1"):
            times_s: list[float] = []
            for _ in range(repeats):
                times_s += await _refusal(bench, robot, at_once=name == "too far")
                await rearm(robot)
            counts = {"asked": float(repeats), "refused": float(len(times_s))}
            figures[name] = percentiles(times_s) | counts
    return figures


async def _refusal(bench: Bench, robot: SiasunRpcRobot, *, at_once: bool) -> list[float]:
    """Seconds from a wrong setpoint to its refusal; nothing where its stream ended otherwise."""
    asked_s = 0.0
    try:
        limits = robot.stream_offer().limits
        async with robot.stream(limits) as stream:
            start = stream.report.base_T_flange
            for step in range(1, BEFORE_REFUSAL + 1):
                await stream.advance(_down(step * limits.step_m) * start)
            if not at_once:
                bench.refuse()
            asked_s = time.monotonic()
            wrong = BEFORE_REFUSAL + (TOO_FAR if at_once else 1)
            await stream.advance(_down(wrong * limits.step_m) * start)
    except (TargetOutOfBounds, SetpointRefused):
        return [time.monotonic() - asked_s]
    except CellError as fault:
        print(f"a stream ended before its refusal: {fault}", file=sys.stderr)
    return []


def _down(way_m: float) -> RigidTransform:
    return RigidTransform.from_translation([0.0, 0.0, -way_m])
