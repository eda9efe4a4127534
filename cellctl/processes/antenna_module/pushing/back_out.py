"""Straight out of the socket after a fault; a plug that is held stops the arm."""

from cellctl import log
from cellctl.cell.guarded_motion.guard_limits import guard_limits
from cellctl.cell.guarded_motion.leaving import able_to_leave
from cellctl.errors.base import CellError
from cellctl.errors.force import ForceError, LiftOffHeld
from cellctl.errors.line import LineLostInContact
from cellctl.processes.antenna_module.faults.plugging import PluggingError
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt

_log = log.get(__name__)
SPEED_M_S, ACCELERATION_M_S2 = 1e-3, 0.01
"""So slow that a plug which is held is pulled with little more than the limit until the arm
stands."""
PULL_RATIO = 1.7
"""Contacts need up to so many times the force of mating to come apart: measured on connectors to
MIL-DTL-55302G by their makers, 1.07 N against 0.62 N."""
SIDE_N, MOMENT_N_M = 10.0, 0.5
"""How far side force and moments may grow beyond those that press now: a reading may be off its
mean by this much."""


async def back_out(attempt: PushAttempt, fault: CellError, stand_off_m: float) -> None:
    """Stop, then out to the stand-off where that is right; what fails is noted on the fault.

    Faults of the robot leave the arm where it is. Aborts and stops never come here: they cancel.
    """
    try:
        # First of all, whatever the fault was: the arm may still be on its way into the socket.
        await attempt.robot.stop()
        pressing = isinstance(fault, (PluggingError, ForceError, LineLostInContact))
        if pressing and able_to_leave(attempt.robot, attempt.guard):
            # The guard must be released first: as long as it wants a stop, it asks for one again at
            # the next beat.
            await attempt.guard.acknowledge()
            await attempt.robot.rearm()
            await leave(attempt, stand_off_m)
    except CellError as second:
        fault.add_note(f"while backing out: {second}")
        _log.warning("backing out incomplete", fault=str(fault), second=str(second))


async def leave(attempt: PushAttempt, stand_off_m: float) -> None:
    """Slowly up to the stand-off; raises ``LiftOffHeld`` when the plug does not come."""
    fx, fy, fz, mx, my, mz = (abs(float(value)) for value in await attempt.read())
    pull_n = PULL_RATIO * attempt.limits.greatest_n
    # What presses may go, and grow by no more than a reading is off its mean; along the way the
    # contacts may hold as long as they slide.
    most = (fx + SIDE_N, fy + SIDE_N, max(fz + SIDE_N, pull_n))
    turn = (mx + MOMENT_N_M, my + MOMENT_N_M, mz + MOMENT_N_M)
    await attempt.arm_with(guard_limits((*most, *turn), attempt.sensing))
    here = attempt.robot.state().base_T_flange
    # From where the stop has left the arm, not from where it was sent.
    up_m = attempt.way.depth_of(here) + stand_off_m
    target = attempt.way.outwards_from(here, up_m)
    trip = await attempt.move(
        attempt.robot.move_linear(target, speed_m_s=SPEED_M_S, acceleration_m_s2=ACCELERATION_M_S2)
    )
    if trip is not None and trip.force:
        raise LiftOffHeld(f"while backing out of the socket: {trip}")
    if trip is not None:
        raise trip.fault()
    await attempt.guard.disarm()
