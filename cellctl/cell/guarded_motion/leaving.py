"""Whether an arm that presses on something may leave it by itself, and how hard it presses."""

import asyncio
from dataclasses import replace

import numpy as np

from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.errors.force import LiftOffHeld
from cellctl.geometry.pose import Array
from cellctl.guard.client import GuardClient
from cellctl.guard.report import GuardSamples
from cellctl.interfaces import Robot

_READING_S = 0.1
"""Length of the stretch of samples that is averaged: 100 at 1 kHz."""
_LEAST_PULL_N = 5.0
"""Less than this is no pull that could be watched: the noise of a reading, and what a hose makes of
the first millimetre."""


def able_to_leave(robot: Robot, guard: GuardPort) -> bool:
    """The robot lacks nothing but the release of its latch, the guard could stop it again."""
    state, health = robot.state(), guard.health()
    # The latch is what the stop has just set and what rearming will release; everything else that
    # makes a robot not ready needs a person.
    able = replace(state, stop_latched=False).ready
    return able and health.alive and health.stop_channel_up


async def pressed_n(guard: GuardClient, inwards: float, most_n: float) -> float:
    """Force with which a part is pressed into its place, as far as the guard tells; at most
    ``most_n``, and negative where the part is pulled.

    To be asked before a tare, which hides it: a part that is drawn out changes the force by this
    before it is pulled at all. What an earlier tare has hidden counts. ``inwards`` is 1 where z of
    the guard's frame points into the place and -1 where it points out. Without a frame of the part,
    a zero that was taken in it, or a sample, nobody knows: ``most_n``. So it is once daemon or
    guard have been started anew.
    """
    hidden_n = guard.hidden_axial_n
    if not guard.in_part_frame or hidden_n is None:
        return most_n
    wrench = (await _newest(guard)).wrench
    if not len(wrench):
        return most_n
    return min(most_n, -inwards * (hidden_n + float(wrench[:, 2].mean())))


async def newest_raw(guard: GuardClient) -> Array | None:
    """What the sensor itself reads at this moment, shape (6,); None without samples."""
    raw = (await _newest(guard)).raw
    return np.asarray(raw.mean(axis=0)) if len(raw) else None


async def _newest(guard: GuardClient) -> GuardSamples:
    # The clock of the loop is the one that stamps samples, also in a loop whose time is simulated.
    begin_s = asyncio.get_running_loop().time()
    await asyncio.sleep(_READING_S)
    return guard.samples(begin_s)


def change_while_drawn_n(pull_n: float, press_n: float) -> float:
    """Greatest change of force until a part that is pressed is pulled with ``pull_n``.

    A part that is pulled already has the less left. Raises ``LiftOffHeld`` where that is nothing:
    otherwise each new attempt, from a zero of its own, would pull by as much more than the last.
    """
    if pull_n + press_n < _LEAST_PULL_N:
        raise LiftOffHeld(f"it is pulled with {-press_n:.0f} N already, allowed {pull_n:.0f} N")
    return pull_n + press_n
