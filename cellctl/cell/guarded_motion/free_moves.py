"""Moves through free air under the force guard: to home, to measuring poses, in procedures."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guarded_moves import (
    TARE_S,
    WrenchTolerance,
    guarded,
    leave_weight_to_tare,
)
from cellctl.cell.guarded_motion.hanging_load import LEVER_M, require_hanging
from cellctl.cell.guarded_motion.kept_zero import forget_zero
from cellctl.cell.guarded_motion.settling import settle
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.geometry.pose import Array


@asynccontextmanager
async def guarded_section(arm: GuardedRobot, tolerance: WrenchTolerance) -> AsyncIterator[None]:
    """Arm the guard with limits on the wrench at the sensor; disarm it after a good end.

    A trip stops the robot at once, and whoever supervises the guard has its fault. Without a
    gravity compensation the wrench at the beginning, at standstill, is taken as zero, and its
    weight is added to the tolerance: the load is felt again as far as the arm tilts. Raises
    ``TareImplausible`` where that wrench is more than what hangs on the sensor, ``NotSettled`` and
    ``GuardRefused``: without a working guard nothing moves.
    """
    guard = arm.guard
    # Frame and gravity compensation cannot be changed while armed.
    await guard.disarm()
    await guard.set_wrench_frame(None)
    weight_n = 0.0
    if not guard.gravity_compensated:
        await leave_weight_to_tare(guard)
        # A load that still swings would be tared with the force of its swing, and that force would
        # be missing from the limit on one side.
        await settle(guard)
        tare = await guard.tare(TARE_S)
        # What presses or pulls would be missing from the limits, and widen them besides.
        require_hanging(arm, tare.mean)
        weight_n = float(np.linalg.norm(tare.mean[:3]))
    # The tare holds for one orientation. Tilted, the whole weight may appear in any direction, and
    # about the sensor on the lever of the load.
    wider = WrenchTolerance(tolerance.force_n + weight_n, tolerance.moment_n_m + weight_n * LEVER_M)
    await guard.arm(guard_limits(wider.limits, Sensing.of(arm.sensor)))
    # Whatever was in its place has left it.
    await forget_zero(arm)
    # No disarming in a ``finally``: after a fault the arm may not stand yet, and the guard must go
    # on until the stop of the run.
    yield
    await guard.disarm()


async def move_joint_free(cell: Cell, arm: GuardedRobot, joints_rad: Array) -> None:
    """Move to taught joints, shape (6,), at the taught speed; raises the fault of a trip."""
    tolerance = free_tolerance(arm)
    motion = arm.robot.move_joint
    with cell.trips_awaited(arm.sensor_name):
        async with guarded_section(arm, tolerance):
            # ``free_force_n`` was chosen for this speed: faster, the inertia of the load alone
            # would trip the guard.
            speed_ratio = arm.config.speed_percent / 100
            trip = await guarded(arm.robot, arm.guard, motion(joints_rad, speed_ratio=speed_ratio))
            if trip is not None:
                raise trip.fault()


def free_tolerance(arm: GuardedRobot) -> WrenchTolerance:
    """What the load may make of acceleration and tilt at the robot's taught speed."""
    return WrenchTolerance(arm.sensor.free_force_n, arm.sensor.free_moment_n_m)
