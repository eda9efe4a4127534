"""Looks for the holes of pins on which the deck stands: lift, aside, down again.

A pin that meets the face of the deck beside its hole pushes it nowhere, so that giving way finds
nothing. The places are those of the spiral of single touches by which a peg looks for its hole;
each is met with the slow travel and the touch of the mating, under the same limits.
"""

from cellctl.force.contact.compliance import LateralOffset
from cellctl.force.contact.spirals import spiral_points
from cellctl.processes.deck_to_frame.mating.attempt import Attempt
from cellctl.processes.deck_to_frame.mating.limits import fault_of
from cellctl.processes.deck_to_frame.mating.result import GivingWay, MatingPhase, Reading
from cellctl.processes.deck_to_frame.mating.settings import PinSettings

_LIFT_M = 0.3e-3
"""More than arm and contact give way to a touch of 20 N at 1e5 N/m, the softest that is mated."""
_PITCH = 1.2
"""Distance of the places over the catch. Circles on a square grid leave no gap up to 1.4; those on
a spiral need more."""


def places(pins: PinSettings) -> tuple[tuple[float, float], ...]:
    """Offsets (m) from the stand-off that are tried one after the other, nearest first."""
    if pins.search_radius_m == 0.0:
        return ()
    # The first point is the middle, which is the measured place: there the deck stands already.
    _, *others = spiral_points(pins.search_radius_m, _PITCH * pins.catch_m)
    return tuple((float(x_m), float(y_m)) for x_m, y_m in others)


async def try_next_place(attempt: Attempt, reading: Reading) -> float | None:
    """Lift the deck off what it stands on and put it over the next place; the travel there.

    None where all places were tried, or the recipe wants no search; nothing has moved then. The
    guard must be watching the limits of contact. Raises the fault of a trip.
    """
    settings = attempt.plan.settings
    found = places(settings.pins) if settings.pins else ()
    if attempt.places_tried >= len(found):
        return None
    x_m, y_m = found[attempt.places_tried]
    attempt.places_tried += 1
    attempt.tell(MatingPhase.SEARCH, reading, f"place {attempt.places_tried} of {len(found)}")
    lifted_m = reading.travel_m - _LIFT_M
    # First up and only then aside: what it stands on would scratch it.
    await _step(attempt, lifted_m)
    target = LateralOffset(x_m, y_m, attempt.offset.yaw_rad)
    move, attempt.offset = attempt.offset.to(target), target
    attempt.gave_way.append(GivingWay(reading, move, target, searched=True))
    await _step(attempt, lifted_m)
    # The deck swings; a touch detector that is armed at once would sum that up.
    await attempt.read(settings.reading_s, settings.step_settle_s)
    return lifted_m


async def _step(attempt: Attempt, travel_m: float) -> None:
    settings = attempt.plan.settings
    pose = attempt.pose_at(travel_m)
    away_m, _ = attempt.robot.state().distance_to(pose)
    # A controller refuses single steps that are longer.
    if away_m > settings.greatest_segment_m:
        motion = attempt.robot.move_linear(
            pose,
            speed_m_s=settings.back_off_speed_m_s,
            acceleration_m_s2=settings.acceleration_m_s2,
        )
    else:
        motion = attempt.robot.step(pose, speed_m_s=settings.step_speed_m_s)
    trip = await attempt.move(motion)
    if trip is not None:
        raise fault_of(trip, settings)
