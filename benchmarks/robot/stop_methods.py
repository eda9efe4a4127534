"""The ways to stop an arm, each with the driver, the fake controller and the wires it needs."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.guarded_moves import POLL_S, guarded
from cellctl.cell.robot_layers.permitted_robot import PermittedRobot
from cellctl.cell.robot_layers.robot_layer import RobotLayer
from cellctl.guard.client import GuardClient
from cellctl.interfaces.robot import Robot, RobotState
from cellctl.interfaces.stop_channel import StopChannel
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from drivers.robot.siasun_rpc.stop_channel import SiasunRpcStopChannel
from fakes.wire.sri.box import SriBox
from fakes.world.robot import RobotArm
from tests.rigs.waiting import until
from tests.rigs.whole_cell.guard_rig import NOTHING, PATIENT, SETTINGS, noisy
from tests.rigs.wire.duco_rig import duco_rig
from tests.rigs.wire.job_rig import job_rig
from tests.rigs.wire.permit_loop import PERMIT, permit_loop

STATEMENT_S = 0.001
WATCHDOG_MS = 300
DEADMAN_MS = 300
ROUND_MS = 150.0
"""Round of a background job at 1 ms a statement: a hundred statements, the wait for a record, and
half as much again."""
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
    decided_s: Callable[[], float] | None = None
    """Monotonic time of a decision that another program takes after ``stop``; None where ``stop``
    is the decision."""


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


class _GuardedRobot(RobotLayer):
    """Moves as the steps of a process do: beside the guard."""

    def __init__(self, robot: Robot, guard: GuardClient) -> None:
        super().__init__(robot)
        self._guard = guard

    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        move = self._robot.move_linear(
            base_T_flange, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2
        )
        await guarded(self._robot, self._guard, move)
        return self._robot.state(SLOW["stale_s"])


@asynccontextmanager
async def _trip() -> AsyncIterator[Ready]:
    """A trip of the real guard beside jobs that overhear its stop and that of the daemon, so that
    the contact, which the daemon opens, is what stops the arm."""
    async with (
        job_rig(channels=("CMD", "STA", "GRD"), statement_s=STATEMENT_S, **SLOW) as rig,
        permit_loop(rig, watchdog_ms=WATCHDOG_MS) as (io, _),
        AsyncExitStack() as stack,
    ):
        force = [0.0] * 6
        box = SriBox(lambda _: noisy(force))
        sensor = {"transport": "tcp", "host": "127.0.0.1", "rate_hz": 500}
        sensor["port"] = await box.start_tcp()
        stack.push_async_callback(box.stop)
        channel = rig.guard.model_dump(include={"robot_name", "guard_port"})
        guard = GuardClient("sri", sensor, "siasun-sjl", channel, SETTINGS)
        stack.push_async_callback(guard.stop)
        starting = asyncio.create_task(guard.start())
        await rig.connect()
        await starting
        await guard.set_gravity_compensation(NOTHING)
        await until(lambda: guard.health().flange_age_s < PATIENT.flange_age_s)
        await guard.acknowledge()
        await rig.robot.rearm()
        await guard.arm(PATIENT)

        async def stop() -> None:
            # One word of each channel: the repetitions, half a second later, are heard.
            rig.controller.faults.inject("ignore_stop", count=2)
            force[2] = 2.0 * PATIENT.raw[2]

        def decided_s() -> float:
            assert guard.trip is not None
            return guard.trip.time_s

        robot = _GuardedRobot(PermittedRobot(rig.robot, io, PERMIT), guard)
        yield Ready(robot, rig.arm, rig.controller.moving, stop, decided_s)


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
    "trip of the guard, digital output by the daemon": (
        "no program of it", _trip, 1000.0 * POLL_S + 2 * HOST_MS,
    ),
    "RPC, silent guard": (
        "its service", partial(_rpc, silent=True), DEADMAN_MS + HOST_MS,
    ),
}  # fmt: skip
"""What has to work in the controller for the stop, how it is done, and its bound in ms."""
