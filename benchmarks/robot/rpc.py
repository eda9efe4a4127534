"""The driver of collaborative arms on the fake controller: ``make bench-robot``.

Round trips of calls beside a bare socket, streamed motion, and the time to a stop by every channel.
Driver and controller are processes of their own on one machine; the figures say what driver,
library and machine cost, and nothing about a real controller.
"""

import argparse
import asyncio
import json
import os
import platform
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path

from benchmarks.robot.rpc_bench import (
    FORGOTTEN_S,
    HEARTBEAT_MS,
    Bench,
    Figures,
    far_end,
    percentiles,
)
from benchmarks.robot.rpc_streams import refused, streamed
from drivers.robot.siasun_rpc.connection import RpcConnection
from drivers.robot.siasun_rpc.protocol import request

PERIODS_MS = (10, 20, 40)


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
    # The jobs take turns, so that whatever the machine does beside meets all of them alike.
    for _ in range(count):
        for name, job in jobs.items():
            start_s = time.perf_counter()
            await job()
            times[name].append(time.perf_counter() - start_s)
    connection.close()
    writer.close()
    return {name: percentiles(values) for name, values in times.items()}


async def stop_by(
    bench: Bench, stop: Callable[[], Awaitable[None]], repeats: int
) -> dict[str, Figures]:
    """Times from the decision to the arm's order to stop, and to its standstill."""
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
    """Times of stops by the daemon's driver, by the guard, and by heartbeats that stay away."""
    guard = bench.guard()
    result: dict[str, dict[str, Figures]] = {}
    await asyncio.sleep(FORGOTTEN_S)
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


async def measure(*, calls: int, ticks: int, repeats: int) -> dict[str, object]:
    """Everything, one after another."""
    async with far_end() as bench:
        return {
            "machine": f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors",
            "load at the beginning": round(os.getloadavg()[0], 2),
            "round trips": await round_trips(bench, calls),
            "streams": {f"{ms} ms": await streamed(bench, ms, ticks) for ms in PERIODS_MS},
            "refused setpoints": {
                f"{ms} ms": await refused(bench, ms, repeats) for ms in PERIODS_MS
            },
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
