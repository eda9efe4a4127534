"""Begins a streamed contact: guard tared and armed in the frame of the tip, stream open."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.cell.contact_motion.settings import ContactSettings
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.cell.contact_motion.ticks import NoObserver, TickObserver
from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guarded_moves import TARE_S, WrenchTolerance
from cellctl.cell.guarded_motion.kept_zero import Pressed, keep_zero
from cellctl.cell.guarded_motion.settling import settle
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.robot import StreamNotOffered
from cellctl.interfaces.streaming_robot import StreamingRobot, StreamLimits


@asynccontextmanager
async def streamed_contact(
    cell: Cell,
    arm: GuardedRobot,
    frames: ContactFrames,
    settings: ContactSettings,
    limits: StreamLimits,
    *,
    observer: TickObserver | None = None,
) -> AsyncIterator[StreamedContact]:
    """Motions by touch as long as the context lasts; see ``open_contact_loop``."""
    async with open_contact_loop(cell, arm, frames, settings, limits, observer=observer) as loop:
        yield StreamedContact(loop)


@asynccontextmanager
async def open_contact_loop(
    cell: Cell,
    arm: GuardedRobot,
    frames: ContactFrames,
    settings: ContactSettings,
    limits: StreamLimits,
    *,
    observer: TickObserver | None = None,
) -> AsyncIterator[ContactLoop]:
    """The stream and the armed guard; the arm begins out of contact, at standstill.

    The guard watches ``settings.limit_n`` and ``limit_n_m`` about the tip; ``watch_closer`` makes
    them tighter for a phase. Raises ``StreamNotOffered``, ``LoopTooSlow``, ``LoopUnstable``,
    ``NotSettled``, ``GuardRefused``, and on leaving what the stream raises.
    """
    settings.check()
    robot, guard = arm.robot, arm.guard
    if not isinstance(robot, StreamingRobot):
        raise StreamNotOffered(f"{robot.name} follows no stream of setpoints")
    # Frame and tare cannot be changed while armed: the signal would jump against the limits.
    await guard.disarm()
    sensor_T_tip = arm.flange_T_sensor.inv() * frames.flange_T_tip
    await guard.set_wrench_frame(sensor_T_tip)
    await settle(guard)
    tare = await guard.tare(TARE_S)
    # Out of contact, with z of the tip into what it will touch: a restart knows its force by this.
    await keep_zero(arm, sensor_T_tip, Pressed(inwards=1.0, force_n=0.0))
    tolerance = WrenchTolerance(settings.limit_n, settings.limit_n_m)
    with cell.trips_awaited(arm.sensor_name):
        await guard.arm(guard_limits(tolerance.limits, Sensing.of(arm.sensor)))
        async with robot.stream(limits) as stream:
            yield ContactLoop(
                stream,
                guard,
                tare,
                frames,
                settings=settings,
                observer=observer or NoObserver(),
            )
        # After a fault the guard stays armed or latched: whoever handles the fault decides when
        # watching may end.
        await guard.disarm()


async def watch_closer(
    contact: StreamedContact, arm: GuardedRobot, tolerance: WrenchTolerance
) -> None:
    """Have the guard watch these limits from now on, while the arm stands in its stream.

    Motions in the free keep below them, too.
    """
    limits = guard_limits(tolerance.limits, Sensing.of(arm.sensor))
    await contact.hold_while(arm.guard.arm(limits))
    contact.watched_n = tolerance.force_n
