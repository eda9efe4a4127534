"""Times from the call of a motion to its acceptance, beside a bare socket: ``make bench-robot``.

    python -m benchmarks.robot.acks --calls 300 --out build/acks.json

Short steps and releases of the driver over each way to an arm: SJL/1, the shipped jobs at two
speeds of their interpreter, and the remote interface of collaborative arms. Before each of them as
many bytes go over a bare socket and back, so that whatever the PC does beside meets both alike.
Controllers and the other end of the socket are processes of their own on this PC. The figures say
what driver, job and machine cost; a real controller adds its own time.
"""

import argparse
import asyncio
import json
import multiprocessing
import os
import sys
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from unittest import mock

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.robot.far_controllers import Ports, serve_controller
from benchmarks.robot.rpc_bench import far_end
from benchmarks.robot.stalls import StallWatch
from cellctl.interfaces.robot import Robot
from drivers.robot.siasun.channels.running_command import RunningCommand
from drivers.robot.siasun.driver import SiasunRobot
from drivers.robot.siasun_rpc.motion import Motion
from tests.rigs.wire.ports import free_ports
from tests.rigs.wire.sjl_rig import arm_settings

STEP_M, SPEED_M_S = 0.0002, 0.02
RECORD_BYTES = 119
"""Size of a command to the jobs. The other records are about as long, and each fits into one
packet."""
SLOW = {"stale_s": 2.0, "silence_s": 3.0, "reply_timeout_s": 5.0}
"""Time-outs of the driver that a busy PC does not reach."""


@dataclass(frozen=True, slots=True)
class AckRow:
    """Milliseconds: of the acceptances, and of the bare socket in the same run."""

    way: str
    calls: int
    p50_ms: float
    p99_ms: float
    max_ms: float
    socket_p50_ms: float
    socket_p99_ms: float
    stall_ms: float
    """Longest time for which driver or controller got no turn on this PC."""


Wait = Callable[..., Awaitable[None]]


@dataclass(slots=True)
class Far:
    """The arm, and how long its controller got no turn, which is known when it has ended."""

    robot: Robot
    stalled_s: float = 0.0


class Accepted:
    """Notes when a driver has learned that its command is accepted."""

    def __init__(self) -> None:
        self.time_s = 0.0

    @contextmanager
    def noted(self) -> Iterator[None]:
        """Have both drivers write the note as long as the context lasts."""
        acknowledged = self._noting(RunningCommand.acknowledged, first=False)
        # The answer of the remote interface is the number of a task. The driver has it when it
        # asks, at once, whether the guard has stopped the arm.
        asked = self._noting(Motion.check_guard, first=True)
        with (
            mock.patch.object(RunningCommand, "acknowledged", acknowledged),
            mock.patch.object(Motion, "check_guard", asked),
        ):
            yield

    def _noting(self, wait: Wait, *, first: bool) -> Wait:
        async def noted(*arguments: object) -> None:
            if first:
                self.time_s = time.perf_counter()
            await wait(*arguments)
            if not first:
                self.time_s = time.perf_counter()

        return noted


@asynccontextmanager
async def sjl_arm(way: str, statement_s: float) -> AsyncIterator[Far]:
    """A driver connected to a controller in a process of its own."""
    command, state = free_ports(2)
    ports: Ports = {"CMD": command, "STA": state}
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=serve_controller, args=(theirs, way, ports, statement_s))
    process.start()
    robot = SiasunRobot("arm", arm_settings(command, state, connect_timeout_s=20.0, **SLOW))
    far = Far(robot)
    try:
        async with robot:
            await robot._state.wait(lambda status: not status.latched, 10.0)
            yield far
    finally:
        ours.send("end")
        far.stalled_s = await asyncio.to_thread(ours.recv)
        process.join(5.0)


@asynccontextmanager
async def rpc_arm() -> AsyncIterator[Far]:
    """The same over the remote interface; only the driver's own process is watched."""
    async with far_end() as bench, bench.robot() as robot:
        yield Far(robot)


WAYS: dict[str, Callable[[], AbstractAsyncContextManager[Far]]] = {
    "SJL/1": partial(sjl_arm, "sjl", 0.0),
    "jobs, 0.2 ms a statement": partial(sjl_arm, "jobs", 0.0002),
    "jobs, 1 ms a statement": partial(sjl_arm, "jobs", 0.001),
    "remote interface (RPC)": rpc_arm,
}


async def measure(way: str, calls: int) -> list[AckRow]:
    """One way, call by call beside the bare socket: steps, which the controller plans before it
    answers, and releases, which move nothing and which the remote interface does not have."""
    times: dict[str, list[float]] = {"step": [], "release": []}
    bare: list[float] = []
    accepted = Accepted()
    stalls = StallWatch()
    async with far_end() as bench, WAYS[way]() as far, stalls:
        robot = far.robot
        reader, writer = await asyncio.open_connection("127.0.0.1", bench.echo_port)
        home = robot.state(2.0).base_T_flange
        for turn in range(calls):
            start_s = time.perf_counter()
            writer.write(bytes(RECORD_BYTES))
            await reader.readexactly(RECORD_BYTES)
            bare.append(time.perf_counter() - start_s)
            up = RigidTransform.from_translation([0.0, 0.0, STEP_M * ((turn + 1) % 2)])
            moves: dict[str, Callable[[], Awaitable[object]]] = {
                "step": partial(robot.step, up * home, speed_m_s=SPEED_M_S),
                "release": robot.rearm,
            }
            for name, move in moves.items():
                start_s = time.perf_counter()
                with accepted.noted():
                    await move()
                if accepted.time_s > start_s:
                    times[name].append(accepted.time_s - start_s)
        # Wait until the far end has hung up too: nothing is left open when it is told to end.
        writer.write_eof()
        await reader.read()
        writer.close()
    stall_ms = round(1000 * max(stalls.longest_s, far.stalled_s), 1)
    rows = []
    for name, found in times.items():
        if found:
            figures = [*_ms(found, 50, 99, 100), *_ms(bare, 50, 99), stall_ms]
            rows.append(AckRow(f"{way}: {name}", len(found), *figures))
    return rows


def _ms(seconds: list[float], *percents: int) -> list[float]:
    return [round(1000 * float(np.percentile(seconds, percent)), 3) for percent in percents]


def table(rows: list[AckRow]) -> str:
    """The rows as a table of a document."""
    lines = [
        "| way | calls | p50, ms | p99, ms | max, ms | bare socket p50, ms | p99, ms "
        "| longest stall, ms |",
        "|---|" + "--:|" * 7,
    ]
    lines += [
        f"| {row.way} | {row.calls} | {row.p50_ms:.2f} | {row.p99_ms:.2f} | {row.max_ms:.2f} "
        f"| {row.socket_p50_ms:.2f} | {row.socket_p99_ms:.2f} | {row.stall_ms:.0f} |"
        for row in rows
    ]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Print the table, and write the figures where ``--out`` says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=300)
    parser.add_argument("--way", choices=sorted(WAYS), nargs="+", default=list(WAYS))
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    load = os.getloadavg()[0]
    rows = [row for way in options.way for row in asyncio.run(measure(way, options.calls))]
    print(table(rows))
    print(f"load of this PC: {load:.1f} before, {os.getloadavg()[0]:.1f} after")
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
