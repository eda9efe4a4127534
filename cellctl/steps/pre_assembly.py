"""Step 30: the deck to its stand-off above the frame (paper 2.2.2, eq. 5 to 7)."""

from cellctl.steps.run import AssemblyRun
from cellctl.vision.compensation import flange_target


async def pre_assembly(run: AssemblyRun) -> None:
    """First assembly motion, from the two measured poses."""
    assert run.c1_T_M is not None
    assert run.flange_T_deck is not None
    commanded = run.target_M_T_D
    run.base_T_flange = flange_target(run.base_T_c1, run.c1_T_M.pose, commanded, run.flange_T_deck)
    run.commanded.append(commanded)
    await run.move_flange(run.base_T_flange)
