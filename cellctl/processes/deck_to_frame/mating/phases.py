"""The phases up to the touch: settle and tare, travel while clear, guarded travel."""

import numpy as np

from cellctl.errors.force import ContactPlanInvalid, ForceError, NotSettled, TareImplausible
from cellctl.geometry.pose import MM, Array
from cellctl.guard.report import GuardTrip
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.faults import ContactEarly, ContactLate
from cellctl.processes.deck_to_frame.mating.attempt import Attempt, loop_time_s
from cellctl.processes.deck_to_frame.mating.comply import check_lateral_load, resolve_early_contact
from cellctl.processes.deck_to_frame.mating.limits import (
    contact_limits,
    fault_of,
    touch_limits,
    travel_limits,
)
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, Reading, Tare

_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


def require_stand_off(robot: Robot, plan: MatingPlan) -> None:
    """The robot must stand where the plan begins; raises ``ContactPlanInvalid``."""
    state = robot.state()
    distance_m, angle_rad = state.distance_to(plan.base_T_flange)
    allowed_m, allowed_rad = plan.settings.stand_off_tolerance
    # Written so that a pose that is not a number counts as elsewhere.
    there = distance_m <= allowed_m and angle_rad <= allowed_rad
    if not there or state.moving:
        raise ContactPlanInvalid(
            f"robot is {distance_m / MM:.3f} mm and {np.rad2deg(angle_rad):.4f}° away from the "
            f"planned stand-off{' and moving' if state.moving else ''}"
        )


async def settle_and_tare(attempt: Attempt) -> Tare:
    """Wait for a steady wrench, check that it is plausible, and take it as zero.

    Raises ``NotSettled`` or ``TareImplausible``.
    """
    plan, settings = attempt.plan, attempt.plan.settings
    attempt.tell(MatingPhase.TARE)
    sensor_T_deck = plan.flange_T_sensor.inv() * plan.flange_T_deck
    # The wrench frame and the tare cannot be changed while armed.
    await attempt.guard.disarm()
    await attempt.guard.set_wrench_frame(sensor_T_deck)
    await _steady(attempt)
    tare = await attempt.guard.tare(settings.tare_s)
    mean, sigma = np.asarray(tare.mean), np.asarray(tare.sigma)
    # What is taken as zero is not seen any more: a deck that already touches would begin the mating
    # with a hidden force.
    _require_plausible(mean, settings.plausible)
    return Tare(mean, sigma)


async def travel_clear(attempt: Attempt) -> None:
    """Fast to where contact is still excluded; any contact on the way is ``ContactEarly``."""
    plan, settings = attempt.plan, attempt.plan.settings
    attempt.tell(MatingPhase.FAST)
    await attempt.guard.arm(travel_limits(settings))
    trip = await attempt.move(
        attempt.robot.move_linear(
            attempt.pose_at(plan.window.clear_m),
            speed_m_s=settings.fast_speed_m_s,
            acceleration_m_s2=settings.acceleration_m_s2,
        )
    )
    if trip is None:
        return
    # Contact where vision excludes it. Other trips are faults of sensor or links and keep their own
    # number.
    if trip.force or trip.touch:
        raise _early(attempt, trip)
    raise fault_of(trip, attempt.plan.settings)


async def travel_to_touch(attempt: Attempt) -> float:
    """Slowly until the guard detects the touch and stops; returns the travel at the touch.

    The way is cut into moves so short that even a robot that obeyed no stop could not exceed the
    force limit. Raises ``ContactEarly``, ``ContactLate`` or the fault of another trip.
    """
    plan, settings = attempt.plan, attempt.plan.settings
    # The fast travel has just ended and the deck swings. Armed at once, the detector would sum up
    # the swing to a touch.
    await attempt.read(settings.reading_s / 2.0, settings.step_settle_s)
    await attempt.guard.arm(touch_limits(settings))
    commanded_m = plan.window.clear_m
    # The margin is far below what the arm can move; without it rounding could ask for one more move
    # of no length.
    while commanded_m < plan.window.latest_m - 1e-9:
        attempt.tell(MatingPhase.SLOW)
        begin_s = loop_time_s()
        commanded_m = min(commanded_m + plan.segment_m, plan.window.latest_m)
        pose = attempt.pose_at(commanded_m)
        trip = await attempt.move(attempt.robot.step(pose, speed_m_s=plan.speed.speed_m_s))
        if trip is None:
            # A sensor that repeats its values feels no touch. The guard looks for that as well;
            # this check does not depend on its limits.
            attempt.require_alive(attempt.guard.samples(begin_s).raw)
            await check_lateral_load(attempt)
        elif _at_pins(attempt, trip):
            await take_over(attempt)
            commanded_m = await resolve_early_contact(attempt)
        else:
            return _touched(attempt, trip)
    return await _touch_at_standstill(attempt)


async def take_over(attempt: Attempt) -> None:
    """Called after the touch stop: release the latches, and watch the force of the creep
    instead."""
    # The guard first, and armed before the robot can move again: no motion without somebody who
    # watches.
    await attempt.guard.acknowledge()
    await attempt.guard.arm(contact_limits(attempt.plan.settings))
    await attempt.robot.rearm()


def _at_pins(attempt: Attempt, trip: GuardTrip) -> bool:
    """True for a touch above the window where pins are expected and may be given way to."""
    early = attempt.recorder.travel_at(trip.time_s) < attempt.plan.window.earliest_m
    return attempt.plan.compliance is not None and (trip.touch or trip.force) and early


async def _touch_at_standstill(attempt: Attempt) -> float:
    """Travel of a contact that is found only at standstill: at the end of the window a soft contact
    may press too little for the detector. Raises ``ContactLate`` without one."""
    settings = attempt.plan.settings
    reading = await _reading_or_touch(attempt)
    if reading is None:
        return attempt.recorder.travel_at(loop_time_s())
    # A force up to the drift does not count for the detector, and three standard deviations keep
    # noise from looking like contact.
    if reading.force_n < settings.touch.drift_n + 3.0 * settings.force_sigma_n:
        window = attempt.plan.window
        raise ContactLate(
            f"no contact up to {window.latest_m / MM:.3f} mm, expected at "
            f"{window.expected_m / MM:.3f} mm; force there {reading.force_n:.1f} N"
        )
    return reading.travel_m


async def _reading_or_touch(attempt: Attempt) -> Reading | None:
    settings = attempt.plan.settings
    try:
        return await attempt.read(settings.reading_s, settings.step_settle_s)
    except ForceError:
        trip = attempt.guard.trip
        # A touch that comes while the arm stands at the end of its window is the contact that was
        # looked for.
        if trip is not None and trip.touch:
            # As after a touch on the way: the guard's stop alone would be one that nobody here has
            # asked for.
            await attempt.robot.stop()
            return None
        raise


def _touched(attempt: Attempt, trip: GuardTrip) -> float:
    if not (trip.touch or trip.force):
        raise fault_of(trip, attempt.plan.settings)
    travel_m = attempt.recorder.travel_at(trip.time_s)
    # Early comes before overforce: a limit that is reached above the window says that something is
    # in the way, and not that the mating pressed too hard.
    if travel_m < attempt.plan.window.earliest_m:
        raise _early(attempt, trip)
    if trip.force:
        raise fault_of(trip, attempt.plan.settings)
    return travel_m


def _early(attempt: Attempt, trip: GuardTrip) -> ContactEarly:
    window = attempt.plan.window
    travel_m = attempt.recorder.travel_at(trip.time_s)
    return ContactEarly(
        f"contact after {travel_m / MM:.3f} mm, expected at {window.expected_m / MM:.3f} mm and "
        f"not before {window.earliest_m / MM:.3f} mm; {trip}"
    )


async def _steady(attempt: Attempt) -> None:
    settings = attempt.plan.settings
    force_limit, moment_limit = settings.settle_sigma
    limits = np.array([force_limit] * 3 + [moment_limit] * 3)
    give_up_s = loop_time_s() + settings.settle_timeout_s
    while True:
        reading = await attempt.read(settings.settle_s)
        ratio = reading.sigma / limits
        if ratio.max() < 1.0:
            return
        if loop_time_s() > give_up_s:
            worst = int(np.argmax(ratio))
            raise NotSettled(
                f"{_COMPONENTS[worst]} scatters by {reading.sigma[worst]:.2f}, allowed "
                f"{limits[worst]:.2f} (N, N·m), after {settings.settle_timeout_s:.0f} s"
            )


def _require_plausible(mean: Array, plausible: tuple[float, float]) -> None:
    force_n, moment_n_m = float(np.linalg.norm(mean[:3])), float(np.linalg.norm(mean[3:]))
    # Written so that a mean that is not a number is refused.
    if not (force_n <= plausible[0] and moment_n_m <= plausible[1]):
        raise TareImplausible(
            f"compensation leaves {force_n:.1f} N and {moment_n_m:.1f} N·m, allowed "
            f"{plausible[0]:.0f} N and {plausible[1]:.0f} N·m"
        )
