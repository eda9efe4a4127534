"""Step 30: bring the deck to its stand-off above the frame (paper 2.2.2, eq. 5 to 7)."""

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.poses.pose_correction import flange_target
from cellctl.processes.deck_to_frame.state import AtStandOff, DeckMeasured


async def pre_assembly(deck: DeckMeasured) -> AtStandOff:
    """First assembly motion, from the two measured poses.

    The frame may really stand higher than it was measured, by no more than the station tolerance:
    the last stretch of that height is slow.
    """
    run = deck.run
    commanded = run.target_M_T_D
    higher = RigidTransform.from_translation([0.0, 0.0, run.recipe.station_tolerance_mm * MM])
    above, base_T_flange = (
        flange_target(run.base_T_c1, deck.c1_T_M, M_T_D, deck.flange_T_deck)
        for M_T_D in (higher * commanded, commanded)
    )
    await run.recorder.commanded(base_T_flange)
    await run.move_flange(above, deck.flange_T_deck)
    await run.move_near_frame(base_T_flange, deck.flange_T_deck)
    return AtStandOff(
        run, deck.frame, deck.flange_T_deck, commanded=commanded, base_T_flange=base_T_flange
    )
