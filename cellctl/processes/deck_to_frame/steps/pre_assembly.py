"""Step 30: the deck to its stand-off above the frame (paper 2.2.2, eq. 5 to 7)."""

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.pose_correction import flange_target
from cellctl.processes.deck_to_frame.run import AssemblyRun


async def pre_assembly(run: AssemblyRun) -> None:
    """First assembly motion, from the two measured poses.

    The frame may really stand higher than it was measured, by no more than the station tolerance:
    the last stretch of that height is slow.
    """
    assert run.c1_T_M is not None
    assert run.flange_T_deck is not None
    commanded = run.target_M_T_D
    higher = RigidTransform.from_translation([0.0, 0.0, run.recipe.station_tolerance_mm * MM])
    above, run.base_T_flange = (
        flange_target(run.base_T_c1, run.c1_T_M.pose, M_T_D, run.flange_T_deck)
        for M_T_D in (higher * commanded, commanded)
    )
    run.commanded.append(commanded)
    await run.move_flange(above)
    await run.lower_flange(run.base_T_flange)
