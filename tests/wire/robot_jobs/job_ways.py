"""Ways through the shipped jobs beside the refusals: commands, ends of a motion, and links.

Each names the labels that it comes to, so that a branch of a job that nothing enters is noticed.
"""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
import pytest

from cellctl.errors.base import CellError
from drivers.robot.siasun.stop_channel import SiasunStopChannel
from tests.rigs.wire.any_rig import above, move, rearm, stands, until_moving, within
from tests.rigs.wire.job_rig import JobRig

STARTED = {"LINK", "READ", "MORE"}
BACKGROUND = {"LINK", "LOOP", "BEAT", "CUT", "WATCH", "PANEL", "PERMIT", "STATE", "POSE", "SUM"}

Run = Callable[[JobRig], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class Way:
    """What happens on a connected rig, and which labels of which job it comes to."""

    run: Run
    enters: dict[str, set[str]] = field(default_factory=dict)


async def _commands(rig: JobRig) -> None:
    """Each of the accelerations that are written out, a joint move and a release."""
    for acceleration_m_s2 in (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0):
        target = above(rig, 1.0)
        await rig.robot.move_linear(target, speed_m_s=0.05, acceleration_m_s2=acceleration_m_s2)
    joints_rad = rig.robot.state().joints_rad + np.radians([0, 0, 0, 0, 0, 0.2])
    await rig.robot.move_joint(joints_rad, speed_ratio=1.0)
    await rig.robot.rearm()


def _in_a_motion(happens: Callable[[JobRig], object], reason: str | None) -> Run:
    """A motion that something ends, and the reason that is told; None where nobody can be told."""

    async def run(rig: JobRig) -> None:
        moving = move(rig, 100.0, 0.05)
        await until_moving(rig)
        happens(rig)
        with pytest.raises(CellError, match=reason):
            await within(3.0, moving)
        await stands(rig)
        assert rig.arm.cut_short

    return run


def _fault(name: str) -> Callable[[JobRig], object]:
    return lambda rig: rig.controller.faults.inject(name)


def _open_contact(rig: JobRig) -> None:
    rig.controller.contact_closed = lambda: False


async def _back_after_a_loss(rig: JobRig) -> None:
    rig.wires["CMD"].reset()
    await rearm(rig)


async def _stop(rig: JobRig) -> None:
    moving = move(rig, 100.0, 0.05)
    await until_moving(rig)
    await within(2.0, rig.robot.stop())
    with pytest.raises(CellError, match="STOP"):
        await moving
    await rearm(rig)


async def _stop_in_pieces(rig: JobRig) -> None:
    """The word of a stop arrives before its number."""
    rig.wires["STA"].back.split = True
    await _stop(rig)


def _guarded(happens: Callable[[SiasunStopChannel, JobRig], object]) -> Run:
    """The same with a guard that beats, and in a motion does something."""

    async def run(rig: JobRig) -> None:
        channel = SiasunStopChannel(rig.guard)
        await within(3.0, asyncio.to_thread(channel.open))
        beating = asyncio.create_task(_beat(channel))
        try:
            await rig.robot._state.wait(lambda status: not status.latched, 2.0)
            moving = move(rig, 100.0, 0.05)
            await until_moving(rig)
            happens(channel, rig)
            with pytest.raises(CellError):
                await within(3.0, moving)
            await stands(rig)
        finally:
            beating.cancel()
            channel.close()

    return run


async def _beat(channel: SiasunStopChannel) -> None:
    with suppress(CellError):
        while True:
            channel.poll()
            channel.heartbeat()
            await asyncio.sleep(0.02)


def _split_stop(channel: SiasunStopChannel, rig: JobRig) -> None:
    rig.wires["GRD"].back.split = True
    channel.request_stop()


_STOPPED = STARTED | {"STOPPED", "ABORTED", "POSE"}
_PANEL = {"SJLSTA": {"REFUSED"}}
WAYS: dict[str, Way] = {
    "commands": Way(
        _commands,
        {
            "SJLMAIN": STARTED
            | {"STRAIGHT", "ACC2", "ACC5", "ACC10", "ACC20", "ACC50", "ACC100", "JOINTS", "ARRIVED"}
            | {"POSE", "REARM"},
            "SJLSTA": BACKGROUND,
        },
    ),
    "contact of the PC": Way(_in_a_motion(_open_contact, "STOP"), {"SJLMAIN": _STOPPED}),
    "silent PC": Way(
        _in_a_motion(lambda rig: setattr(rig.wires["STA"].back, "blocked", True), "DEADMAN"),
        {"SJLMAIN": _STOPPED | {"DEAD"}},
    ),
    "lost state": Way(
        _in_a_motion(lambda rig: rig.wires["STA"].reset(), None),
        {"SJLMAIN": {"UNLINKED"}, "SJLSTA": {"LOST", "CLOSE"}},
    ),
    "emergency stop": Way(
        _in_a_motion(_fault("emergency_stop"), "ESTOP"), {"SJLMAIN": {"EMERGENCY"}} | _PANEL
    ),
    "key": Way(_in_a_motion(_fault("manual_mode"), "MODE"), {"SJLMAIN": {"TURNED"}} | _PANEL),
    "drives": Way(
        _in_a_motion(_fault("drives_off"), "DRIVES"), {"SJLMAIN": {"UNPOWERED"}} | _PANEL
    ),
    "error": Way(_in_a_motion(_fault("vendor_error"), "error"), {"SJLMAIN": {"FAULTY"}} | _PANEL),
    "lost commands": Way(_back_after_a_loss, {"SJLMAIN": {"LOST"}}),
    "stop": Way(_stop, {"SJLSTA": {"STOP", "OPEN", "CUT"}}),
    "stop in pieces": Way(_stop_in_pieces, {"SJLSTA": {"STOP", "OPEN"}}),
    "stop of the guard": Way(
        _guarded(lambda channel, _: channel.request_stop()),
        {"SJLGRD": BACKGROUND | {"STOP", "OPEN"}},
    ),
    "stop of the guard in pieces": Way(_guarded(_split_stop), {"SJLGRD": {"STOP", "OPEN"}}),
    "lost guard": Way(
        _guarded(lambda _, rig: rig.wires["GRD"].reset()), {"SJLGRD": {"LOST", "CLOSE"}}
    ),
    "key beside a guard": Way(
        _guarded(lambda _, rig: rig.controller.faults.inject("manual_mode")),
        {"SJLGRD": {"REFUSED"}},
    ),
}
