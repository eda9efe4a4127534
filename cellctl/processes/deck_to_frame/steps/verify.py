"""Step 60: measure the seated deck against the frame (offset at the pin holes, gap, rotation)."""

from collections.abc import Iterator

from cellctl.cell.guarded_motion.contact_recorder import ContactRecorder
from cellctl.errors.force import ForceLimitExceeded
from cellctl.force.contact.curve import ForceCurve, curve_statistics
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.faults import SeatedOffPosition
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement
from cellctl.processes.deck_to_frame.poses.seat_error import SeatError, pin_holes, seat_error
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.state import Seated, Verified


async def verify(seat: Seated) -> Verified:
    """Measure the deck where it sits; raises ``SeatedOffPosition`` unless it is surely in place.

    The lateral offset is judged at the pin holes, at every hole of a part that has none; the gap
    between deck and frame in the middle of the face. The mating has judged the gap by the travel of
    the arm; the cameras do not depend on that. A figure that is within its limit by less than its
    uncertainty proves nothing (docs/decisions/0016): it is measured once more, with all frames.

    Nothing moves here, so that the guard would have nothing to stop. Whoever presses on the deck
    meanwhile presses it out of the seat that was judged: raises ``ForceLimitExceeded`` beyond the
    limit of the mating.
    """
    run = seat.run
    async with ContactRecorder(run.cell.main, run.cell.guard, lambda _: 0.0) as contact:
        measurement, found = await _look(seat)
        if list(unproven_seat(found, run.recipe)):
            await run.recorder.measurement("seated", measurement)
            measurement, found = await _look(seat, run.recipe.pose_correction.max_frames)
    force_n = _greatest_n(contact.curve())
    # Recorded before it is judged: a part beyond its limits needs its figures more than a good one.
    await run.recorder.verification(found, run.recipe, measurement, force_n)
    if pins := pin_holes(run.facts.deck_features.holes):
        await run.recorder.gauge_holes(pins, run.recipe)
    if unproven := list(unproven_seat(found, run.recipe)):
        raise SeatedOffPosition("; ".join(unproven))
    # Written so that a force that is not known is refused.
    if not force_n <= (limit_n := run.recipe.mating.limit_force_n):
        raise ForceLimitExceeded(
            f"{force_n:.1f} N on the seated deck while it was verified, allowed {limit_n:g} N"
        )
    return Verified(
        run,
        seat.frame,
        seat.flange_T_deck,
        seat.commanded,
        seat.base_T_flange,
        seat.M_T_D,
        seat.measured_at,
    )


def _greatest_n(curve: ForceCurve) -> float:
    """Greatest force along the approach, filtered as the guard does; NaN without samples."""
    if len(curve.time_s) < 2:
        return float("nan")
    return curve_statistics(curve.time_s, curve.wrench).peak_filtered_fz_n


async def _look(seat: Seated, frames: int | None = None) -> tuple[PartMeasurement, SeatError]:
    run = seat.run
    # The arm still holds the deck, so its pose says where the holes are to be looked for.
    flange = run.cell.main.state().base_T_flange
    predicted = run.base_T_c1.inv() * flange * seat.flange_T_deck
    measurement = await run.measure(run.facts.deck_features, predicted, frames)
    M_T_D = run.measurer.deck_in_frame(seat.frame, measurement.pose).cautious
    thickness_m = run.recipe.deck_thickness_mm * MM
    return measurement, seat_error(M_T_D, thickness_m, run.facts.deck_features.holes)


def unproven_seat(found: SeatError, recipe: DeckRecipe) -> Iterator[str]:
    """What of a seat is not surely within its limit, in words; what is not a number is not."""
    for name, value in found.offsets_mm.items():
        uncertainty_mm = found.offset_uncertainties_mm[name]
        if not value + uncertainty_mm <= recipe.seated_limit_mm:
            allowed = f"allowed {recipe.seated_limit_mm:g} mm"
            yield f"{name} {value:.3f} ± {uncertainty_mm:.3f} mm, {allowed}"
    if not abs(found.gap_mm) + found.gap_uncertainty_mm <= recipe.seated_gap_limit_mm:
        yield (
            f"gap {found.gap_mm:+.3f} ± {found.gap_uncertainty_mm:.3f} mm, "
            f"allowed {recipe.seated_gap_limit_mm:g} mm"
        )
    rotation = found.rotation(recipe.seated_limits_deg)
    if not rotation.value_deg <= rotation.acceptance_deg:
        yield (
            f"turned about {rotation.axis} by {rotation.value_deg:.4f} ± "
            f"{rotation.uncertainty_deg:.4f}°, allowed {rotation.limit_deg:g}°"
        )
