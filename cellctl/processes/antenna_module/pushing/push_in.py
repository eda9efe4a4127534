"""From the stand-off to the seat (docs/plugging.md, "Judging an insertion")."""

from collections import deque

from cellctl.cell.guarded_motion.guarded_moves import Motion
from cellctl.errors.base import CellError
from cellctl.geometry.pose import MM
from cellctl.guard.report import GuardTrip
from cellctl.processes.antenna_module.faults.plugging import (
    PlugEarlyContact,
    PluggingError,
    PlugOverForce,
    PlugShortSeat,
    PlugSideForce,
)
from cellctl.processes.antenna_module.insertion.limits import InsertionPhase
from cellctl.processes.antenna_module.insertion.watch import InsertionTrip, TripCause
from cellctl.processes.antenna_module.pushing.attempt import PushAttempt

ACCELERATION_M_S2 = 0.02
"""Acceleration so low that gripper and module, 3 kg, make less than a tenth of a newton of it."""
FINE_M = 0.02e-3
"""Length of a move near the seat: what holds the plug is so stiff that a tenth of a millimetre more
would be 50 N."""
_AXIAL = 2
_FEWEST_SAMPLES = 20
"""Fewest samples that show the features of a curve: as many as that of a file must have."""


async def push_in(attempt: PushAttempt, step_m: float) -> float:
    """Push the plug to its seat; the depth there, as the flange says.

    No move is longer than ``step_m``, and after each the arm stands while the wrench is read: a
    stop that is not obeyed costs one step. Raises a ``PluggingError`` that says what was met, and
    the faults of guard, sensor and robot.
    """
    limits = attempt.limits
    await _travel_near(attempt)
    depth_m = -limits.entry_height_m
    phase = None
    deepest_m = limits.seat_depth_m + limits.seat_tolerance_m
    seat = _SeatFinder(limits.seat_rise_n, limits.seat_within_m)
    while True:
        next_m = min(depth_m + _step_m(attempt, depth_m, step_m), deepest_m)
        # As deep as the drawing allows, and nothing has stopped the plug.
        if next_m <= depth_m:
            raise PlugShortSeat(f"no seat felt down to {depth_m / MM:.2f} mm")
        # Of the step and not of its end, which is where the next phase begins.
        bounds = limits.at((depth_m + next_m) / 2.0)
        if bounds.phase is not phase:
            # Armed anew at standstill: within a phase the limits are the same everywhere.
            await attempt.arm(bounds)
            phase = bounds.phase
        # A step and not a straight move: the controller itself refuses one that is too long.
        motion = attempt.robot.step(attempt.way.pose_at(next_m), speed_m_s=bounds.speed_m_s)
        await _watched(attempt, motion, phase)
        depth_m = next_m
        wrench = await attempt.read()
        if seat.felt(depth_m, float(wrench[_AXIAL])):
            return depth_m


def _step_m(attempt: PushAttempt, depth_m: float, step_m: float) -> float:
    limits = attempt.limits
    fine_from_m = limits.seat_depth_m - limits.seat_tolerance_m - step_m
    touch_m = -limits.early_touch_m
    if depth_m >= fine_from_m:
        return FINE_M
    if touch_m - 1e-9 <= depth_m < limits.spring_depth_m:
        step_m = min(step_m, limits.entry_step_m)
    # A move must not lead from one phase into another, whose limits are others.
    bounds_m = [edge_m - depth_m for edge_m in (touch_m, limits.spring_depth_m, fine_from_m)]
    return min([step_m, *(bound_m for bound_m in bounds_m if bound_m > 1e-9)])


async def _travel_near(attempt: PushAttempt) -> None:
    """Travel to just above the first touch; nothing may be felt on the way."""
    limits = attempt.limits
    above = limits.at(-limits.entry_height_m - 1e-6)
    await attempt.arm(above)
    motion = attempt.robot.move_linear(
        attempt.way.pose_at(-limits.entry_height_m),
        speed_m_s=above.speed_m_s,
        acceleration_m_s2=ACCELERATION_M_S2,
    )
    await _watched(attempt, motion, above.phase)


async def _watched(attempt: PushAttempt, motion: Motion, phase: InsertionPhase) -> None:
    """Run a move, then judge its samples by what the guard cannot: trend and centre of pressure."""
    trip = await attempt.move(motion)
    if trip is not None:
        raise await _fault(attempt, trip, phase)
    found = attempt.feed_watch()
    if found is not None:
        raise await _met(attempt, found.cause, _words(found))


def _words(trip: InsertionTrip) -> str:
    return (
        f"{trip.cause.value} {trip.value:.3g}, allowed {trip.limit:.3g}, at a depth of "
        f"{trip.depth_m / MM:.2f} mm"
    )


async def _fault(attempt: PushAttempt, trip: GuardTrip, phase: InsertionPhase) -> CellError:
    """What a trip of the guard means here; of sensor or links it stays what it is."""
    if not trip.force:
        return trip.fault()
    if trip.component == _AXIAL:
        cause = TripCause.OVER if phase is InsertionPhase.SLIDING else TripCause.AXIAL_EARLY
    else:
        cause = TripCause.SIDE
    return await _met(attempt, cause, str(trip))


_BY_CAUSE: dict[TripCause, type[PluggingError]] = {
    TripCause.AXIAL_EARLY: PlugEarlyContact,
    TripCause.SIDE: PlugSideForce,
    TripCause.MOMENT: PlugSideForce,
    TripCause.PRESSURE: PlugSideForce,
    TripCause.OVER: PlugOverForce,
}


async def _met(attempt: PushAttempt, cause: TripCause, words: str) -> PluggingError:
    """The fault that the curve up to now names. It may name a contact, which a trip cannot."""
    # At the entry the curve can name a single bent contact. That there is no seat yet is no fault:
    # the push has just begun.
    if cause is TripCause.AXIAL_EARLY and len(attempt.curve().t_s) >= _FEWEST_SAMPLES:
        judged = (await attempt.judged()).fault
        if judged is not None and not isinstance(judged, PlugShortSeat):
            return type(judged)(f"{words}; {judged.detail}")
    return _BY_CAUSE[cause](words)


class _SeatFinder:
    """Notices that the force rises as it does at a seat."""

    def __init__(self, rise_n: float, within_m: float) -> None:
        self._rise_n, self._within_m = rise_n, within_m
        self._readings: deque[tuple[float, float]] = deque()

    def felt(self, depth_m: float, axial_n: float) -> bool:
        """The next reading at standstill; True when it lies on a seat."""
        self._readings.append((depth_m, axial_n))
        while self._readings[0][0] < depth_m - self._within_m - 1e-9:
            self._readings.popleft()
        return axial_n - min(force_n for _, force_n in self._readings) > self._rise_n
