"""Step 60: measure the seated deck against the frame (below 0.2 mm at the pin holes)."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.vision import SeatedOffPosition
from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.poses.pose_correction import assembly_error, deck_in_frame
from cellctl.processes.deck_to_frame.state import Seated, Verified


async def verify(seat: Seated) -> Verified:
    """Measure the deck where it sits; raises ``SeatedOffPosition`` beyond the recipe's limit.

    Judged at the pin holes, at every hole of a part that has none.
    """
    run = seat.run
    flange = run.cell.main.state().base_T_flange
    measurement = await run.measure(
        run.facts.deck_features, run.base_T_c1.inv() * flange * seat.flange_T_deck
    )
    M_T_D = deck_in_frame(seat.c1_T_M.pose, measurement.c1_T_part)
    seated = RigidTransform.from_translation([0.0, 0.0, run.recipe.deck_thickness_mm * MM])
    holes = run.facts.deck_features.holes
    judged = [hole for hole in holes if hole.kind == "pin"] or holes
    offsets_mm = {
        hole.name: float(np.linalg.norm((M_T_D.apply(hole.position_m) - hole.position_m)[:2])) / MM
        for hole in judged
    }
    limit_mm = run.recipe.seated_limit_mm
    error = assembly_error(seated, M_T_D)
    await run.journal.verification(error, offsets_mm, limit_mm, measurement)
    off = {name: value for name, value in offsets_mm.items() if value > limit_mm}
    if off:
        text = ", ".join(f"{name} {value:.3f} mm" for name, value in off.items())
        raise SeatedOffPosition(f"{text}; allowed {limit_mm:g} mm")
    return Verified(
        run,
        seat.c1_T_M,
        seat.flange_T_deck,
        seat.commanded,
        seat.base_T_flange,
        seat.M_T_D,
        seat.measured_at,
    )
