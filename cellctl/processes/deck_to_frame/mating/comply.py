"""Lets the deck give way, at standstill, to pins that it meets on the way to its seat."""

import numpy as np

from cellctl.force.contact.compliance import next_move, pressed
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.faults import ContactEarly
from cellctl.processes.deck_to_frame.mating.attempt import Attempt, loop_time_s
from cellctl.processes.deck_to_frame.mating.limits import contact_limits, fault_of, touch_limits
from cellctl.processes.deck_to_frame.mating.pin_search import try_next_place
from cellctl.processes.deck_to_frame.mating.result import GivingWay, MatingPhase, Reading

GLANCE_S = 0.15
"""The last part of a move; its mean tells whether a reading at standstill is worth its time."""


async def comply(attempt: Attempt, reading: Reading) -> Reading:
    """Move across the approach until the reading is quiet or a bound is reached; the last one.

    The guard must be watching the limits of contact. Raises the fault of a trip.
    """
    settings, law = attempt.plan.settings, attempt.plan.compliance
    if law is None:
        return reading
    # Bounded: a side force that no move takes away, such as friction, is left to the limits of the
    # seat.
    for _ in range(settings.max_creep_steps):
        move = next_move(law, attempt.offset, reading.wrench)
        if move is None:
            break
        attempt.offset = attempt.offset.plus(move)
        attempt.gave_way.append(GivingWay(reading, move, attempt.offset))
        attempt.tell(MatingPhase.GIVE_WAY, reading)
        pose = attempt.pose_at(reading.travel_m)
        trip = await attempt.move(attempt.robot.step(pose, speed_m_s=settings.step_speed_m_s))
        if trip is not None:
            raise fault_of(trip, settings)
        reading = await attempt.read(settings.reading_s, settings.step_settle_s)
    return reading


async def check_lateral_load(attempt: Attempt) -> None:
    """Called after each move of the guarded travel: give way where the samples of its end ask for
    it."""
    law = attempt.plan.compliance
    if law is None:
        return
    wrench = attempt.guard.samples(loop_time_s() - GLANCE_S).wrench
    if not len(wrench) or not pressed(law, np.asarray(wrench.mean(axis=0))):
        return
    settings = attempt.plan.settings
    # Moves across the approach may make forces that the touch detector would take for the seat.
    await attempt.guard.arm(contact_limits(settings))
    await comply(attempt, await attempt.read(settings.reading_s, settings.step_settle_s))
    await attempt.guard.arm(touch_limits(settings))


async def resolve_early_contact(attempt: Attempt) -> float:
    """Called after a touch above the seat that was taken over: give way and go on; returns the
    travel that is reached (m).

    Where the force along the approach stays, the deck stands on a pin or on something else: it is
    put over the next place of the recipe's search. Raises ``ContactEarly`` when there is none left.
    Touches that never end are one too.
    """
    settings, window = attempt.plan.settings, attempt.plan.window
    reading = await attempt.read(settings.reading_s, settings.step_settle_s)
    reading = await comply(attempt, reading)
    attempt.touches_above += 1
    # Below the drift of the detector the next move can begin as if in free air (docs/mating.md,
    # "What if the stop is not obeyed").
    stays = reading.force_n > settings.touch.drift_n
    many = attempt.touches_above > settings.max_creep_steps
    reached_m = reading.travel_m
    if stays and not many:
        lifted_m = await try_next_place(attempt, reading)
        stays, reached_m = lifted_m is None, reached_m if lifted_m is None else lifted_m
    if stays or many:
        raise ContactEarly(
            f"contact after {reading.travel_m / MM:.3f} mm, expected at "
            f"{window.expected_m / MM:.3f} mm; giving way by "
            f"{attempt.offset.distance_m / MM:.3f} mm leaves {reading.force_n:.1f} N "
            f"({attempt.touches_above} touches, {attempt.places_tried} other places)"
        )
    await attempt.guard.arm(touch_limits(settings))
    return reached_m
