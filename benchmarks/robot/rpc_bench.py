"""The far end of the benchmark of collaborative arms, and how to reach it."""

import asyncio
import contextlib
import multiprocessing
from collections.abc import AsyncIterator
from multiprocessing.connection import Connection

import numpy as np

from benchmarks.robot.far_end import Stamp, serve
from cellctl.errors.base import CellError
from drivers.robot.siasun_rpc.config import SiasunRpcConfig, SiasunRpcStopChannelConfig
from drivers.robot.siasun_rpc.driver import SiasunRpcRobot
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel

PERCENTILES = (50, 99, 100)
REARM_S = 10.0
HEARTBEAT_MS = 400
FORGOTTEN_S = 2.0 * HEARTBEAT_MS / 1000
"""Time after which the controller has missed the heartbeats of a client that has gone, and has done
what it does then; before, that would disturb the next measurement."""
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

    def refuse(self) -> None:
        """The controller answers the next motion or setpoint with -1."""
        self._pipe.send("refuse")
        self._pipe.recv()

    async def stamps(self) -> dict[str, float]:
        """First stamp of each kind since the turn began, once the arm stands."""
        self._pipe.send("stamps")
        stamps: list[Stamp] = await asyncio.to_thread(self._pipe.recv)
        return dict(reversed(stamps))


async def rearm(robot: SiasunRpcRobot) -> None:
    """Re-arm as an operator does: again until the link is back and the arm stands."""
    async with asyncio.timeout(REARM_S):
        while True:
            with contextlib.suppress(CellError):
                await robot.connect()
                return await robot.rearm()
            await asyncio.sleep(0.1)


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
