"""The driver of collaborative arms on the fake controller: ``make bench-robot``.

Round trips of calls beside a bare socket, streamed motion, and the time to a stop by every channel.
Driver and controller are processes of their own on one machine; the figures say what driver,
library and machine cost, and nothing about a real controller.
"""

import argparse
import asyncio
import contextlib
import json
import multiprocessing
import os
import platform
import sys
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from itertools import pairwise
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.robot.far_end import Stamp, serve
from cellctl.errors.base import CellError
from cellctl.interfaces.streaming_robot import StreamReport
from drivers.robot.siasun_rpc.config import SiasunRpcConfig, SiasunRpcStopChannelConfig
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.driver import SiasunRpcRobot
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel

PERCENTILES = (50, 99, 100)
MOST_ENDS = 10
REARM_S = 10.0
HEARTBEAT_MS = 400
FORGOTTEN_S = 2.0 * HEARTBEAT_MS / 1000
"""After so long the controller has missed the heartbeats of a client that has gone, and done what
it does then; it would disturb the next measurement."""
CONTROLLER = {
    "host": "127.0.0.1", "tool": "flange", "work_frame": "base", "euler": "fixed-xyz",
    "stop_word": 1, "rearm_word": 2, "heartbeat_ms": HEARTBEAT_MS,
}  # fmt: skip
ARM = CONTROLLER | {
    "workspace_min_mm": (-3000.0,) * 3, "workspace_max_mm": (3000.0,) * 3,
    "joints_min_deg": (-360.0,) * 6, "joints_max_deg": (360.0,) * 6,
    "max_speed_mm_s": 250.0, "max_stream_travel_mm": 200.0,
}  # fmt: skip
Figures = dict[str, float]


class Bench:
    """The far end and how to reach it."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self.rpc_port, self.state_port, self.echo_port = pipe.recv()

    def robot(self, period_ms: int | None = None) -> SiasunRpcRobot:
        """A driver that is not connected."""
        settings = {"rpc_port": self.rpc_port, "state_port": self.state_port}
        return SiasunRpcRobot(
            "arm", SiasunRpcConfig.model_validate(ARM | settings | {"servo_period_ms": period_ms})
        )

    def guard(self) -> SiasunRpcStopChannel:
        """A stop channel that is not open."""
        settings = CONTROLLER | {"rpc_port": self.rpc_port}
        return SiasunRpcStopChannel(SiasunRpcStopChannelConfig.model_validate(settings))

    def move(self) -> None:
        """The arm begins a slow turn of several seconds, by nobody's call."""
        self._pipe.send("move")
        self._pipe.recv()

    async def stamps(self) -> dict[str, float]:
        """First stamp of each kind since the turn began, once the arm stands."""
        self._pipe.send("stamps")
        stamps: list[Stamp] = await asyncio.to_thread(self._pipe.recv)
        return dict(reversed(stamps))


async def round_trips(bench: Bench, count: int) -> dict[str, Figures]:
    """A question, and the state's six questions in one piece, beside as many bytes on a socket."""
    question = request("robotmoving")
    connection = RpcConnection("bench", lambda _: None)
    await connection.open("127.0.0.1", bench.rpc_port)
    reader, writer = await asyncio.open_connection("127.0.0.1", bench.echo_port)

    async def ask() -> None:
        await connection.exchange(question, timeout_s=5.0)

    async def ask_six() -> None:
        await connection.exchange(*[question] * 6, timeout_s=5.0)

    async def echo() -> None:
        writer.write(question.data)
        await reader.readexactly(len(question.data))

    jobs = {"bare socket": echo, "one call": ask, "six calls in one piece": ask_six}
    times: dict[str, list[float]] = {name: [] for name in jobs}
    # In turn, so that whatever the machine does beside meets all of them alike.
    for _ in range(count):
        for name, job in jobs.items():
            start_s = time.perf_counter()
            await job()
            times[name].append(time.perf_counter() - start_s)
    connection.close()
    writer.close()
    return {name: percentiles(values) for name, values in times.items()}


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


async def rearm(robot: SiasunRpcRobot) -> None:
    """As an operator does: again until the link is back and the arm stands."""
    async with asyncio.timeout(REARM_S):
        while True:
            with contextlib.suppress(CellError):
                await robot.connect()
                return await robot.rearm()
            await asyncio.sleep(0.1)


async def _stream(robot: SiasunRpcRobot, ticks: int, reports: list[StreamReport]) -> None:
    limits = robot.stream_offer().limits
    async with robot.stream(limits) as stream:
        start, way = stream.report.base_T_flange, int(limits.travel_m / limits.step_m) // 2
        while stream.report.tick < ticks:
            step = way - abs(len(reports) % (2 * way) - way)
            down = RigidTransform.from_translation([0.0, 0.0, -step * limits.step_m])
            reports.append(await stream.advance(down * start))


async def stop_by(
    bench: Bench, stop: Callable[[], Awaitable[None]], repeats: int
) -> dict[str, Figures]:
    """From the decision to the arm's order to stop, and to its standstill."""
    ordered, standing = [], []
    for _ in range(repeats):
        bench.move()
        await asyncio.sleep(0.3)  # until it moves at its full speed
        start_s = time.monotonic()
        await stop()
        stamps = await bench.stamps()
        ordered.append(stamps["halt"] - start_s)
        standing.append(stamps["stand"] - start_s)
    return {"ordered": percentiles(ordered), "standing": percentiles(standing)}


async def stops(bench: Bench, repeats: int) -> dict[str, dict[str, Figures]]:
    """By the daemon's driver, by the guard, and by heartbeats that stay away."""
    guard = bench.guard()
    result: dict[str, dict[str, Figures]] = {}
    async with bench.robot() as robot:
        result["driver"] = await stop_by(bench, robot.stop, repeats)
    await asyncio.sleep(FORGOTTEN_S)

    async def request_stop() -> None:
        guard.request_stop()

    async def beat_once() -> None:
        guard.poll()
        guard.heartbeat()

    guard.open()
    result["guard"] = await stop_by(bench, request_stop, repeats)
    guard.close()
    await asyncio.sleep(FORGOTTEN_S)
    guard.open()
    result[f"no heartbeat ({HEARTBEAT_MS} ms)"] = await stop_by(bench, beat_once, repeats)
    guard.close()
    return result


def percentiles(seconds: list[float]) -> Figures:
    """Milliseconds by percentile; nothing without a time."""
    if not seconds:
        return {}
    return {
        f"p{percent}_ms": round(float(np.percentile(seconds, percent)) * 1000, 3)
        for percent in PERCENTILES
    }


@contextlib.asynccontextmanager
async def far_end() -> AsyncIterator[Bench]:
    """The far end as long as the context lasts."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=serve, args=(theirs,))
    process.start()
    try:
        yield Bench(ours)
    finally:
        ours.send("end")
        process.join(5.0)


async def measure(*, calls: int, ticks: int, repeats: int) -> dict[str, object]:
    """Everything, one after another."""
    async with far_end() as bench:
        return {
            "machine": f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors",
            "load at the beginning": round(os.getloadavg()[0], 2),
            "round trips": await round_trips(bench, calls),
            "streams": {f"{ms} ms": await streamed(bench, ms, ticks) for ms in (8, 20, 40)},
            "stops": await stops(bench, repeats),
            "load at the end": round(os.getloadavg()[0], 2),
        }


def main(arguments: list[str] | None = None) -> int:
    """Print the figures, and write them where ``--out`` says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=2000)
    parser.add_argument("--ticks", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    job = measure(calls=options.calls, ticks=options.ticks, repeats=options.repeats)
    text = json.dumps(asyncio.run(job), indent=2)
    print(text)
    if options.out is not None:
        options.out.write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
