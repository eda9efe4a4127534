"""One motion of the shipped jobs at a set speed of their interpreter, and what ends it."""

import asyncio
import random
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.errors.link import LinkError
from drivers.robot.siasun.codec.records import Record, Status
from drivers.robot.siasun.connection import SjlChannel
from tests.rigs.wire.job_rig import JobRig, job_rig

SPEED_M_S = 0.02
LATE_S = 0.25
"""How late one answer of a PC that is alive comes: less than its dead man's time."""
STATEMENTS_A_ROUND = 110
"""Statements in a round of a background job, roughly: a cause comes at any of them."""
ROUNDS_A_MOTION = 6
ENDLESS_S = 60.0
LIMITS: dict[str, Any] = {
    "stale_s": ENDLESS_S, "silence_s": ENDLESS_S, "reply_timeout_s": ENDLESS_S,
    "stop_timeout_s": ENDLESS_S, "connect_timeout_s": ENDLESS_S,
}  # fmt: skip
"""Time-outs of the driver are widened so that none hides what the jobs do."""


@dataclass(frozen=True, slots=True)
class Trial:
    """Milliseconds: period of the reports, from a command to its motion, and from the cause to the
    order to brake, None for a motion that went on to its end."""

    report_ms: float
    begin_ms: float
    stop_ms: float | None


class InLoopGuard:
    """The PC's end of GRD as the guard speaks it: an answer to each report, and a stop.

    The guard itself waits in a thread of its own, which knows nothing of a time that jumps.
    """

    def __init__(self, rig: JobRig) -> None:
        self.channel = SjlChannel(
            "GRD", rig.guard.robot_name, max_deadman_s=1.0, robot_address="",
            on_up=lambda: None, on_record=self._answer, on_lost=_nothing,
        )  # fmt: skip
        self._port = rig.guard.guard_port
        self._beats = 0
        self.reported = asyncio.Event()

    async def listen(self) -> None:
        """Open the port."""
        await self.channel.listen("127.0.0.1", self._port)

    def stop(self) -> None:
        """Ask the job to stop."""
        self.channel.send(self.channel.words.abort(self.channel.session, 1))

    def _answer(self, record: Record) -> None:
        if isinstance(record, Status):
            self._beats += 1
            self.channel.send(self.channel.words.beat(self.channel.session, self._beats))
            self.reported.set()


def _nothing(_: LinkError) -> None:
    return


@dataclass
class Slow:
    """A connected arm and, for some causes, its guard."""

    rig: JobRig
    guard: InLoopGuard | None
    rng: random.Random


Cause = Callable[[Slow], Awaitable[None]]


async def _sta_stop(slow: Slow) -> None:
    slow.rig.robot._state.request_stop()


async def _sta_silence(slow: Slow) -> None:
    slow.rig.wires["STA"].back.blocked = True


async def _grd_stop(slow: Slow) -> None:
    assert slow.guard is not None
    slow.guard.stop()


async def _grd_silence(slow: Slow) -> None:
    slow.rig.wires["GRD"].back.blocked = True


async def _contact(slow: Slow) -> None:
    slow.rig.controller.contact_closed = lambda: False


async def _one_late_answer(slow: Slow) -> None:
    """The answer to the next report comes late, as from a PC that was busy for a moment."""
    back = slow.rig.wires["STA"].back
    back.delay_s = LATE_S
    await slow.rig.robot._state.wait(lambda _: True, ENDLESS_S)
    await asyncio.sleep(LATE_S)
    back.delay_s = 0.0


async def _undisturbed(_: Slow) -> None:
    return


CAUSES: dict[str, Cause] = {
    "STA stop": _sta_stop,
    "GRD stop": _grd_stop,
    "STA silent": _sta_silence,
    "GRD silent": _grd_silence,
    "contact": _contact,
    "one late answer": _one_late_answer,
    "undisturbed": _undisturbed,
}
STOPPING = ("STA stop", "GRD stop", "STA silent", "GRD silent", "contact")
ALIVE = ("one late answer", "undisturbed")
"""Causes after which the arm must go on, since the PC is there."""


async def trial(statement_s: float, cause: str, rng: random.Random) -> Trial:
    """One motion. The cause comes at any phase of a round of the job."""
    async with _connected(statement_s, guarded=cause.startswith("GRD"), rng=rng) as slow:
        report_ms = await _report_ms(slow.rig)
        return await _stopped(slow, CAUSES[cause], statement_s, report_ms)


@asynccontextmanager
async def _connected(
    statement_s: float, *, guarded: bool, rng: random.Random
) -> AsyncIterator[Slow]:
    async with job_rig(
        channels=("CMD", "STA", "GRD") if guarded else ("CMD", "STA"),
        statement_s=statement_s,
        **LIMITS,
    ) as rig:
        guard = InLoopGuard(rig) if guarded else None
        if guard is not None:
            await guard.listen()
        await rig.connect()
        # The background jobs close the permit loop in their first rounds.
        await rig.robot._state.wait(lambda status: not status.latched, ENDLESS_S)
        if guard is not None:
            await guard.reported.wait()
        try:
            yield Slow(rig, guard, rng)
        finally:
            if guard is not None:
                await guard.channel.close()


async def _report_ms(rig: JobRig) -> float:
    times_s: list[float] = []
    while len(times_s) < 3:
        await rig.robot._state.wait(lambda _: True, ENDLESS_S)
        times_s.append(time.monotonic())
    return 1000 * (times_s[-1] - times_s[0]) / (len(times_s) - 1)


async def _stopped(slow: Slow, cause: Cause, statement_s: float, report_ms: float) -> Trial:
    rig, round_s = slow.rig, STATEMENTS_A_ROUND * statement_s
    way_m = SPEED_M_S * (0.5 + ROUNDS_A_MOTION * round_s)
    up = RigidTransform.from_translation([0.0, 0.0, way_m])
    target = up * rig.robot.state(ENDLESS_S).base_T_flange
    await asyncio.sleep(slow.rng.uniform(0.0, round_s))
    begun, braked = _noted(rig)
    asked_s = time.monotonic()
    move = asyncio.create_task(
        rig.robot.move_linear(target, speed_m_s=SPEED_M_S, acceleration_m_s2=1.0)
    )
    begun_s = await asyncio.wait_for(begun, ENDLESS_S)
    await asyncio.sleep(slow.rng.uniform(1.0, 2.0) * round_s)
    caused_s = time.monotonic()
    causing = asyncio.ensure_future(cause(slow))
    # A motion that nothing stops ends by itself.
    ends: set[asyncio.Future[Any]] = {braked, move}
    await asyncio.wait(ends, timeout=ENDLESS_S, return_when=asyncio.FIRST_COMPLETED)
    causing.cancel()
    # Without a link nobody waits until the stop has ended.
    for wire in rig.wires.values():
        wire.reset()
    await asyncio.gather(causing, move, return_exceptions=True)
    stop_ms = 1000 * (braked.result() - caused_s) if braked.done() else None
    return Trial(report_ms, 1000 * (begun_s - asked_s), stop_ms)


def _noted(rig: JobRig) -> "tuple[asyncio.Future[float], asyncio.Future[float]]":
    """When the arm begins its next motion, and when it is told to brake."""
    loop, arm = asyncio.get_running_loop(), rig.arm
    begun: asyncio.Future[float] = loop.create_future()
    braked: asyncio.Future[float] = loop.create_future()
    start, stop = arm.start_linear, arm.stop

    def started(*arguments: Any) -> None:
        start(*arguments)
        begun.set_result(time.monotonic())

    def stopped(time_s: float, *, latency_s: float | None = None) -> None:
        stop(time_s, latency_s=latency_s)
        if not braked.done():
            braked.set_result(time.monotonic())

    arm.start_linear, arm.stop = started, stopped  # type: ignore[method-assign, assignment]
    return begun, braked
