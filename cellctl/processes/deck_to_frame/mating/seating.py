"""The phases in contact: creep to the force, hold and judge, relax, back off."""

import numpy as np

from cellctl.errors.force import CommissioningFailed
from cellctl.force.contact.commissioning import StiffnessEstimate, estimate_stiffness
from cellctl.force.contact.creep import CreepLaw, after_step, begin, done, next_step
from cellctl.force.contact.seat import SeatFinding, SeatVerdict, judge_seat
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.faults import CreepNotConverged, LateralLoad
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.comply import comply
from cellctl.processes.deck_to_frame.mating.limits import fault_of
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, Reading

_HOLD_TRIES = 3
"""Readings after which the hold is given up. A force that relaxes is brought back by another
creep."""


async def creep_to(
    attempt: Attempt,
    law: CreepLaw,
    phase: MatingPhase,
    first: Reading | None = None,
    shown_n_m: float | None = None,
) -> tuple[Reading, ...]:
    """Small steps until the force at standstill lies in the law's window; all readings.

    ``first`` spares a reading that was just made. Raises ``CreepNotConverged`` or the fault of a
    trip.
    """
    plan, settings = attempt.plan, attempt.plan.settings
    reading = first or await attempt.read(settings.reading_s, settings.step_settle_s)
    reading = await comply(attempt, reading)
    readings, state = [reading], begin(law, reading.force_n, reading.travel_m, shown_n_m)
    while not done(law, state):
        attempt.tell(phase, reading)
        target_m = state.travel_m + next_step(law, state)
        # A soft or missing contact never reaches the force. Without this bound the creep would
        # follow it past every measured figure.
        if target_m > plan.end_of_travel_m or state.steps >= settings.max_creep_steps:
            raise CreepNotConverged(
                f"{state.force_n:.1f} N after {state.steps} steps at {state.travel_m / MM:.3f} mm, "
                f"wanted {law.reference_n:.1f} N before {plan.end_of_travel_m / MM:.3f} mm"
            )
        trip = await attempt.move(
            attempt.robot.step(attempt.pose_at(target_m), speed_m_s=settings.step_speed_m_s)
        )
        if trip is not None:
            raise fault_of(trip, settings)
        reading = await attempt.read(settings.reading_s, settings.step_settle_s)
        reading = await comply(attempt, reading)
        state = after_step(law, state, reading.force_n, reading.travel_m)
        readings.append(reading)
    attempt.tell(phase, reading)
    return tuple(readings)


async def hold(attempt: Attempt, readings: tuple[Reading, ...]) -> tuple[Reading, SeatVerdict]:
    """Hold the force, creeping again where it relaxes, and judge the seat.

    Raises ``LateralLoad``, or ``CreepNotConverged`` when the force does not hold.
    """
    settings = attempt.plan.settings
    stiffness = stiffness_of(readings)
    stiffness_n_m = stiffness.stiffness_n_m if stiffness else settings.stiffness_n_m
    for _ in range(_HOLD_TRIES):
        reading = await attempt.read(settings.hold_s)
        attempt.tell(MatingPhase.HOLD, reading)
        verdict = judge_seat(
            reading.wrench,
            travel_m=reading.travel_m,
            expected_m=attempt.plan.window.expected_m,
            stiffness_n_m=stiffness_n_m,
            limits=settings.seat,
        )
        # Before the force: with a side load the force along the approach proves nothing.
        if SeatFinding.LATERAL in verdict.findings or SeatFinding.MOMENT in verdict.findings:
            raise LateralLoad(
                f"side force {verdict.lateral_n:.1f} N, moment {verdict.moment_n_m:.1f} N·m"
            )
        # A false seat is a result and no fault: the caller measures again. Only a force that has
        # relaxed is worth another creep.
        if SeatFinding.FORCE_LOW not in verdict.findings:
            return reading, verdict
        await creep_to(attempt, attempt.plan.creep, MatingPhase.CREEP, reading)
    raise CreepNotConverged(f"force does not hold: {verdict.force_n:.1f} N after the hold")


def stiffness_of(readings: tuple[Reading, ...]) -> StiffnessEstimate | None:
    """Stiffness from the readings of the creep, or None when they do not carry one."""
    travel_m = np.array([reading.travel_m for reading in readings])
    force_n = np.array([reading.force_n for reading in readings])
    try:
        return estimate_stiffness(travel_m, force_n)
    except CommissioningFailed:
        return None
