"""Step 60: measure the seated deck against the frame (offset at the pin holes, gap, rotation)."""

from collections.abc import Iterator

from cellctl.errors.vision import SeatedOffPosition
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.poses.pose_correction import deck_in_frame
from cellctl.processes.deck_to_frame.poses.seat_error import SeatError, pin_holes, seat_error
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.state import Seated, Verified


async def verify(seat: Seated) -> Verified:
    """Measure the deck where it sits; raises ``SeatedOffPosition`` beyond the recipe's limits.

    The lateral offset is judged at the pin holes, at every hole of a part that has none; the gap
    between deck and frame in the middle of the face. The mating has judged the gap by the travel of
    the arm; the cameras do not depend on that.
    """
    run = seat.run
    # The arm still holds the deck, so its pose says where the holes are to be looked for.
    flange = run.cell.main.state().base_T_flange
    measurement = await run.measure(
        run.facts.deck_features, run.base_T_c1.inv() * flange * seat.flange_T_deck
    )
    M_T_D = deck_in_frame(seat.c1_T_M.pose, measurement.c1_T_part)
    holes = run.facts.deck_features.holes
    found = seat_error(M_T_D, run.recipe.deck_thickness_mm * MM, holes)
    # Recorded before it is judged: a part beyond its limits needs its figures more than a good one.
    await run.journal.verification(found, run.recipe, measurement)
    if pins := pin_holes(holes):
        await run.journal.gauge_holes(pins, run.recipe)
    beyond = list(_beyond(found, run.recipe))
    if beyond:
        raise SeatedOffPosition("; ".join(beyond))
    return Verified(
        run,
        seat.c1_T_M,
        seat.flange_T_deck,
        seat.commanded,
        seat.base_T_flange,
        seat.M_T_D,
        seat.measured_at,
    )


def _beyond(found: SeatError, recipe: DeckRecipe) -> Iterator[str]:
    """What is not within its limit, in words; a value that is not a number is beyond."""
    limit_mm = recipe.seated_limit_mm
    for name, value in found.offsets_mm.items():
        if not value <= limit_mm:
            yield f"{name} {value:.3f} mm, allowed {limit_mm:g} mm"
    if not abs(found.gap_mm) <= recipe.seated_gap_limit_mm:
        yield f"gap {found.gap_mm:+.3f} mm, allowed {recipe.seated_gap_limit_mm:g} mm"
    if not found.rotation_deg <= recipe.seated_limit_deg:
        yield f"turned by {found.rotation_deg:.4f}°, allowed {recipe.seated_limit_deg:g}°"
