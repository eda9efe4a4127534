"""Backs off from the frame after a fault or a false seat; the guard notices a deck that is held."""

from scipy.spatial.transform import RigidTransform

from cellctl.cell.guarded_motion.guarded_moves import Motion
from cellctl.errors.force import LiftOffHeld
from cellctl.force.contact.approach import advance
from cellctl.force.contact.leaving import FIRST_LIFT_M, leaving_speed_m_s
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.limits import leaving_limits
from cellctl.processes.deck_to_frame.mating.result import MatingPhase
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings


async def back_off(attempt: Attempt) -> None:
    """Along +Z_D from wherever the arm stands, at most to the stand-off, under the guard.

    The zero is that of the stand-off, so a pull is told from the force that is being released. The
    first stretch is so slow that a deck that is held is pulled by ``limit_force_n`` at most once
    more than the guard allows. Releases no latch. Raises the fault of a latched trip, the sensor's
    fault without moving when it gives no live readings, ``LiftOffHeld`` when something holds the
    deck, and the robot's fault when it cannot move.
    """
    here = attempt.robot.state().base_T_flange
    back_m = min(attempt.plan.settings.back_off_m, attempt.plan.travel_of(here))
    target = advance(here, attempt.plan.flange_T_deck, -back_m)
    await _leave(attempt, here, target, back_m)


async def return_to_stand_off(attempt: Attempt) -> None:
    """Move back like ``back_off``, but all the way to the stand-off of the plan."""
    here, plan = attempt.robot.state().base_T_flange, attempt.plan
    await _leave(attempt, here, plan.base_T_flange, plan.travel_of(here))


async def _leave(
    attempt: Attempt, here: RigidTransform, target: RigidTransform, back_m: float
) -> None:
    plan, settings = attempt.plan, attempt.plan.settings
    attempt.raise_trip()
    # At the stand-off there is nothing to leave.
    if back_m <= settings.smallest_step_m:
        await attempt.guard.disarm()
        return
    # The limits of leaving start from what presses at this moment. A sensor without live readings
    # raises here, before anything moves.
    reading = await attempt.read(settings.reading_s, settings.step_settle_s)
    attempt.tell(MatingPhase.BACK_OFF)
    await attempt.guard.arm(leaving_limits(settings, reading.wrench))
    first_m = min(FIRST_LIFT_M, back_m)
    # From where the arm stands and not from a planned travel: a stop has left it anywhere, and pins
    # may have moved it aside.
    pose = advance(here, plan.flange_T_deck, -first_m)
    await _move(attempt, attempt.robot.step(pose, speed_m_s=first_speed_m_s(settings)))
    if back_m > first_m:
        motion = attempt.robot.move_linear(
            target,
            speed_m_s=settings.back_off_speed_m_s,
            acceleration_m_s2=settings.acceleration_m_s2,
        )
        await _move(attempt, motion)
    await attempt.guard.disarm()


def first_speed_m_s(settings: MatingSettings) -> float:
    """Speed of the first stretch, m/s."""
    delay_s = settings.stop_latency_s + settings.stale_s + settings.filter_delay_s
    return leaving_speed_m_s(
        settings.limit_force_n, settings.stiffness_n_m, delay_s, settings.back_off_speed_m_s
    )


async def _move(attempt: Attempt, motion: Motion) -> None:
    trip = await attempt.move(motion)
    if trip is None:
        return
    if trip.touch or trip.force:
        raise LiftOffHeld(f"while backing off: {trip}")
    raise trip.fault()
