"""Reports, after a start that found an interrupted run or an arm that was left in the place of its
part, where the arms stand and what they feel."""

import asyncio
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from cellctl import log
from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.kept_zero import KeptZero, kept_zero, pressed_since
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.clock import now_s
from cellctl.errors import CellError
from cellctl.errors.force import PartLeftInPlace
from cellctl.errors.records.store import RunInterrupted
from cellctl.geometry.pose import pose_to_xyzabc
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.store import RunStore
from cellctl.runtime.process import Process

_log = log.get(__name__)

READING_S = 0.2
"""Length of the stretch of force samples that is averaged: 200 samples at 1 kHz leave a few tenths
of a newton of noise, and nobody waits for them."""
PATIENCE_S = 1.0
"""Longest wait for that stretch. A sensor that sends nothing must not keep the cell from coming
up."""
_POLL_S = 0.02
"""Pause between two looks at the newest sample."""


async def faults_of_before(
    runs: Sequence[int],
    cell: Cell,
    processes: Iterable[Process[Any, Any, Any]],
    store: AsyncRunStore,
) -> list[tuple[int | None, RunInterrupted | PartLeftInPlace]]:
    """A fault for each interrupted run, with its number, and for each arm that was left in the
    place of its part; moves nothing.

    What cannot be found out is said in its place, because a cell that does not come up for it would
    tell even less. Raises the faults of the run store.
    """
    arms = [cell.guarded_robot(name) for name in cell.guards]
    left = [(arm, kept) for arm in arms if (kept := await kept_zero(arm)) is not None]
    if not runs and not left:
        return []
    # First, because it has the guards subtract the weight and use the frame of the part: the forces
    # below are told as they are then.
    for process in processes:
        try:
            await process.show_contact_force()
        except CellError as fault:
            _log.warning("contact force not shown", process=process.name, fault=str(fault))
    here = "; ".join([*_poses(cell), *[await _force(cell, name) for name in cell.guards]])
    found: list[tuple[int | None, RunInterrupted | PartLeftInPlace]] = []
    for arm, kept in left:
        told = await _left(arm, kept)
        found.append((None, PartLeftInPlace(f"{arm.sensor_name}: {told}; now {here}")))
    for run in runs:
        phases = (await store.do(RunStore.run, run)).phases
        step = f"step {phases[-1].number} {phases[-1].label}" if phases else "no step yet"
        found.append((run, RunInterrupted(f"run {run}, {step}; now {here}")))
    return found


async def _left(arm: GuardedRobot, kept: KeptZero) -> str:
    """What the part is pressed or pulled with, and whether something has held it."""
    try:
        force_n = await pressed_since(arm, kept)
    except CellError as fault:
        force = f"with what force is unknown ({fault})"
    else:
        if force_n is None:
            force = "with what force is unknown"
        else:
            force = f"{'pulled' if force_n < 0.0 else 'pressed'} with {abs(force_n):.0f} N"
    since = f"{force}, by the zero of {kept.taken:%Y-%m-%d %H:%M:%S} UTC"
    return f"{since}; something held it: {kept.held}" if kept.held else since


def _poses(cell: Cell) -> list[str]:
    texts = []
    for name, robot in cell.robots.items():
        try:
            x, y, z, a, b, c = pose_to_xyzabc(robot.state().base_T_flange)
            texts.append(f"{name} at {x:.1f} {y:.1f} {z:.1f} mm {a:.2f} {b:.2f} {c:.2f}°")
        except CellError as fault:
            texts.append(f"{name} unknown ({fault})")
    return texts


async def _force(cell: Cell, name: str) -> str:
    """The mean force on one sensor in words; with its components where their axes are the part's.

    A sign in the sensor's own axes would contradict what the line is shown of the same force.
    No tare is taken: nobody knows whether the part is in contact, and a tare would hide just that.
    So the drift of the sensor's zero is part of the figure.
    """
    guard, begin_s = cell.guards[name], now_s()
    try:
        while guard.latest().time_s < begin_s + READING_S:
            if now_s() > begin_s + PATIENCE_S:
                return f"{name}: no fresh samples"
            await asyncio.sleep(_POLL_S)
        x_n, y_n, z_n = guard.samples(begin_s).wrench[:, :3].mean(axis=0)
    except CellError as fault:
        return f"{name}: unknown ({fault})"
    weight = "without the payload's weight" if guard.gravity_compensated else "payload included"
    force_n = float(np.linalg.norm([x_n, y_n, z_n]))
    axes = f" (Fx {x_n:.1f}, Fy {y_n:.1f}, Fz {z_n:.1f} N)" if guard.in_part_frame else ""
    return f"{name}: {force_n:.1f} N{axes}, {weight}"
