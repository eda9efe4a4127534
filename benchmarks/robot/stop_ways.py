"""The ways to stop an arm, each with the driver, the fake controller and the wires it needs."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from cellctl.cell.robot_layers.permitted_robot import PermittedRobot
from cellctl.interfaces.robot import Robot
from cellctl.interfaces.stop_channel import StopChannel
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel
from fakes.world.robot import RobotArm
from tests.rigs.wire.duco_rig import duco_rig
from tests.rigs.wire.job_rig import job_rig
from tests.rigs.wire.permit_loop import PERMIT, permit_loop

STATEMENT_S = 0.001
WATCHDOG_MS = 300
DEADMAN_MS = 300
ROUND_MS = 150.0
"""Of a background job at 1 ms a statement: a hundred statements, the wait for a record, and half as
much again."""
HOST_MS = 50.0
"""What a busy PC may need for one write and its wire."""
SLOW: dict[str, Any] = {
    "stale_s": 10.0,
    "silence_s": 10.0,
    "reply_timeout_s": 10.0,
    "stop_timeout_s": 20.0,
}
"""Time-outs of the driver that would end a motion before the stop that is measured does."""


@dataclass
class Ready:
    """An arm that can be moved, and the way to stop it."""

    robot: Robot
    arm: RobotArm
    moving: Callable[[], bool]
    stop: Callable[[], Awaitable[None]]


Way = Callable[[], AbstractAsyncContextManager[Ready]]


@asynccontextmanager
async def _sta(*, silent: bool) -> AsyncIterator[Ready]:
    async with job_rig(statement_s=STATEMENT_S, **SLOW) as rig:
        await rig.connect()

        async def stop() -> None:
            if silent:
                rig.wires["STA"].back.blocked = True
            else:
                rig.robot._state.request_stop()

        yield Ready(rig.robot, rig.arm, rig.controller.moving, stop)


@asynccontextmanager
async def _grd(*, silent: bool) -> AsyncIterator[Ready]:
    async with job_rig(channels=("CMD", "STA", "GRD"), statement_s=STATEMENT_S, **SLOW) as rig:
        channel = SiasunStopChannel(rig.guard)
        opening = asyncio.create_task(asyncio.to_thread(channel.open))
        await rig.connect()
        await opening
        async with _beating(channel) as beating:
            await rig.robot._state.wait(lambda status: not status.latched, 5.0)
            yield Ready(
                rig.robot,
                rig.arm,
                rig.controller.moving,
                _guards_stop(channel, beating, silent=silent),
            )


@asynccontextmanager
async def _digital(*, silent: bool) -> AsyncIterator[Ready]:
    async with (
        job_rig(statement_s=STATEMENT_S, **SLOW) as rig,
        permit_loop(rig, watchdog_ms=WATCHDOG_MS) as (io, wire),
    ):
        await rig.connect()

        async def stop() -> None:
            if silent:
                wire.forth.blocked = True
            else:
                await io.write({PERMIT: False})

        yield Ready(rig.robot, rig.arm, rig.controller.moving, stop)


@asynccontextmanager
async def _dead_job() -> AsyncIterator[Ready]:
    """An alarm ends the background job and with it dead man and contact of the controller."""
    async with (
        job_rig(statement_s=STATEMENT_S, **SLOW) as rig,
        permit_loop(rig, watchdog_ms=WATCHDOG_MS) as (io, _),
    ):
        await rig.connect()

        async def stop() -> None:
            rig.let_report_overflow()

        robot = PermittedRobot(rig.robot, io, PERMIT)
        yield Ready(robot, rig.arm, rig.controller.moving, stop)


@asynccontextmanager
async def _rpc(*, silent: bool) -> AsyncIterator[Ready]:
    async with duco_rig() as rig:
        await rig.robot.connect()
        channel = SiasunRpcStopChannel(rig.guard)
        await asyncio.to_thread(channel.open)
        async with _beating(channel) as beating:
            yield Ready(
                rig.robot, rig.arm, rig.logic.moving, _guards_stop(channel, beating, silent=silent)
            )


def _guards_stop(
    channel: StopChannel, beating: "asyncio.Task[None]", *, silent: bool
) -> Callable[[], Awaitable[None]]:
    async def stop() -> None:
        if silent:
            beating.cancel()
        else:
            channel.request_stop()

    return stop


@asynccontextmanager
async def _beating(channel: StopChannel) -> AsyncIterator["asyncio.Task[None]"]:
    """The guard's heartbeats, each 20 ms."""

    async def beat() -> None:
        while True:
            channel.poll()
            channel.heartbeat()
            await asyncio.sleep(0.02)

    beating = asyncio.create_task(beat())
    try:
        yield beating
    finally:
        beating.cancel()
        await asyncio.gather(beating, return_exceptions=True)
        channel.close()


_DEAD_ROUNDS_MS = DEADMAN_MS + 2 * ROUND_MS
WAYS: dict[str, tuple[str, Way, float]] = {
    "STA, stop of the daemon": ("its background job", partial(_sta, silent=False), 2 * ROUND_MS),
    "GRD, stop of the guard": ("its background job", partial(_grd, silent=False), 2 * ROUND_MS),
    "digital output of the PC": ("no program of it", partial(_digital, silent=False), HOST_MS),
    "RPC, stop of the guard": ("its service", partial(_rpc, silent=False), HOST_MS),
    "STA, silent daemon": ("its background job", partial(_sta, silent=True), _DEAD_ROUNDS_MS),
    "GRD, silent guard": ("its background job", partial(_grd, silent=True), _DEAD_ROUNDS_MS),
    "digital output, silent PC": (
        "the coupler's watchdog", partial(_digital, silent=True), WATCHDOG_MS + HOST_MS,
    ),
    "digital output, background job ended by an alarm": (
        "no program of it", _dead_job, ROUND_MS + HOST_MS,
    ),
    "RPC, silent guard": (
        "its service", partial(_rpc, silent=True), DEADMAN_MS + HOST_MS,
    ),
}  # fmt: skip
"""What has to work in the controller for the stop, how it is done, and its bound in ms."""
