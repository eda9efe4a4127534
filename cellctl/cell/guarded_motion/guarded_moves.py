"""Moves of a robot while its force guard is armed: a trip ends the move."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.cell.guarded_motion.guard_port import GuardPort
from cellctl.cell.guarded_motion.kept_zero import Pressed, keep_zero, note_held
from cellctl.cell.guarded_motion.settling import settle
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.errors.base import CellError
from cellctl.errors.force import ForceLimitExceeded
from cellctl.errors.robot import MotionAborted, NotRearmed
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.guard.client import GuardClient
from cellctl.guard.limits import Six
from cellctl.guard.report import GuardTrip
from cellctl.interfaces import Robot, RobotMode, RobotState

POLL_S = 0.01
"""Pause between two looks for a trip. It delays only the daemon's second stop: the guard's own has
left by then."""
REPORT_WAIT_S = 0.5
"""How long the guard's report of a trip may lag behind the robot's stop. It takes milliseconds; the
rest is for a daemon that is busy."""
TARE_S = 0.5
"""Length of a tare: the mean of 500 samples at 1 kHz has a twentieth of the noise of one."""

Motion = Coroutine[Any, Any, RobotState]
GuardedMove = Callable[[Motion], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class WrenchTolerance:
    """Largest change of each component of the wrench in its frame, either way."""

    force_n: float
    moment_n_m: float
    axial_n: float | None = None
    """Tolerance along z of the frame, where it differs. A part that is drawn out of what it was
    pressed into first loses the press and then meets the pull: the force changes by both."""

    @property
    def limits(self) -> Six:
        """The tolerance of each component: N, N, N, N·m, N·m, N·m."""
        axial_n = self.force_n if self.axial_n is None else self.axial_n
        return (self.force_n, self.force_n, axial_n, *(self.moment_n_m,) * 3)


@asynccontextmanager
async def guarded_moves(
    cell: Cell,
    arm: GuardedRobot,
    flange_T_wrench: RigidTransform,
    tolerance: WrenchTolerance,
    *,
    leaves: Pressed | None = None,
    braking: WrenchTolerance | None = None,
) -> AsyncIterator[GuardedMove]:
    """Tare at standstill and arm the guard; yields a function that runs one guarded move.

    The limits are on the *change* since then: wherever the arm stands, in contact or not, a move
    that is free changes nothing but inertia. ``flange_T_wrench`` is the frame in which the limits
    hold. A trip stops the robot and raises its fault, and the guard stays latched.

    The zero of the tare holds whatever the sensor feels at the beginning: a weight that is not
    subtracted, so that a move that tilts it changes the force, and the force with which a part is
    pressed into the place that these moves take it out of. ``leaves`` says what is known of that
    force, and is kept on the disk, so that a restart does not forget it.

    ``braking`` is for moves with nothing near: what the load may make of the robot's brakes when
    somebody ends the move, which are harder than its acceleration. Nothing is lost by it, because
    the stop that a trip would ask for was asked for already. Raises ``NotSettled``,
    ``GuardRefused`` and what the moves raise.
    """
    guard = arm.guard

    async def move(motion: Motion) -> None:
        trip = await guarded(arm.robot, guard, motion)
        if trip is not None:
            raise trip.fault()

    # Frame and tare cannot be changed while armed: the signal would jump against the limits.
    await guard.disarm()
    # Settle first: setting load and frame drops the zero, and with it what is known of the force
    # that it hides. If the arm does not settle, the next attempt still needs that.
    await settle(guard)
    await leave_weight_to_tare(guard)
    sensor_T_wrench = arm.flange_T_sensor.inv() * flange_T_wrench
    await guard.set_wrench_frame(sensor_T_wrench)
    await guard.tare(TARE_S, hides_axial_n=0.0 if leaves is None else leaves.axial_n)
    if leaves is not None:
        # Before anything pulls: the daemon may be killed while it does.
        await keep_zero(arm, sensor_T_wrench, leaves)
    with cell.trips_awaited(arm.sensor_name):
        brakes = None if braking is None else braking.limits
        await guard.arm(guard_limits(tolerance.limits, Sensing.of(arm.sensor), braking=brakes))
        # After a fault the guard stays armed or latched: whoever handles the fault decides when
        # watching may end.
        try:
            yield move
        except ForceLimitExceeded as fault:
            if leaves is not None:
                await note_held(arm, str(fault))
            raise
        await guard.disarm()


async def leave_weight_to_tare(guard: GuardClient) -> None:
    """Have the guard subtract nothing, unless it already subtracts a weight.

    A new guard refuses to be armed before somebody has said what hangs on its sensor. After a
    restart the first move may be the one out of a station, and there nobody has.
    """
    if not guard.gravity_compensated:
        await guard.set_gravity_compensation(GravityCompensation.none())


async def guarded(robot: Robot, guard: GuardPort, motion: Motion) -> GuardTrip | None:
    """Run a robot move; None at its target, the trip when the guard stopped it.

    The guard has sent its own stop before it reports; the stop sent here is the second one and
    waits for standstill. Faults of the robot and its link are raised as they are. So is the fault
    of a robot that was stopped at its panel or by an error of its own, although its brakes have
    shaken the load so much that the guard has tripped.
    """
    moving = asyncio.create_task(motion)
    watching = asyncio.create_task(_tripped(guard))
    try:
        await asyncio.wait({moving, watching}, return_when=asyncio.FIRST_COMPLETED)
        # Not only if the watch has ended first: the guard may trip just as the robot arrives.
        if guard.trip is not None:
            # The guard's stop went over its own channel. The daemon's goes over another one, and
            # returns only when the robot confirms that it stands. Without it nobody here has asked
            # for the stop that is latched, which is a fault of its own.
            await _second_stop(robot, guard)
        return await _outcome(robot, guard, moving)
    finally:
        watching.cancel()
        moving.cancel()
        await asyncio.gather(moving, watching, return_exceptions=True)


async def _outcome(
    robot: Robot, guard: GuardPort, moving: asyncio.Task[RobotState]
) -> GuardTrip | None:
    try:
        await moving
    # The robot may report its end before the guard's report of the trip has reached the daemon.
    # Then the abort is the consequence and the trip is the reason.
    except (MotionAborted, NotRearmed) as fault:
        trip = await late_trip(guard)
        if trip is None:
            raise
        await _second_stop(robot, guard)
        if _braked_by_itself(robot.state()):
            fault.add_note(f"the guard felt it too: {trip.detail}")
            raise
        return trip
    return guard.trip


def _braked_by_itself(state: RobotState) -> bool:
    """Whether panel, drives or an error have stopped the robot.

    Its brakes then shake the payload beyond the limits of the guard, and nothing was touched.
    """
    panel = state.emergency_stop or state.mode is not RobotMode.REMOTE
    return panel or not state.drives_on or state.error_code != 0


async def _second_stop(robot: Robot, guard: GuardPort) -> None:
    """The daemon's own stop; a robot that does not confirm it must not hide the trip."""
    try:
        await robot.stop()
    except CellError as fault:
        fault.add_note(f"the guard had stopped the robot: {guard.trip}")
        raise


async def late_trip(guard: GuardPort) -> GuardTrip | None:
    """The trip that has stopped a robot, once the guard has reported it; None when it had none."""
    try:
        async with asyncio.timeout(REPORT_WAIT_S):
            await _tripped(guard)
    except TimeoutError:
        return None
    return guard.trip


async def _tripped(guard: GuardPort) -> None:
    while guard.trip is None:  # noqa: ASYNC110 - set by another process
        await asyncio.sleep(POLL_S)
