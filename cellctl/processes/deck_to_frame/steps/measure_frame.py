"""Step 10: where the frame stands (paper 2.2.1)."""

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.pose_limits import require_near
from cellctl.processes.deck_to_frame.run import AssemblyRun


async def measure_frame(run: AssemblyRun) -> None:
    """Measure the frame with both heads; the deck is still clear of the station."""
    base_T_frame = pose_from_xyzabc(run.recipe.base_T_frame)
    predicted = run.base_T_c1.inv() * base_T_frame
    measurement = await run.measure(run.frame_features, predicted)
    measured = run.base_T_c1 * measurement.c1_T_part
    require_near("frame", run.recipe, base_T_frame, measured)
    run.c1_T_M = measurement.own
    run.cell.base_T_frame = measured
    await run.journal.measurement("frame", measurement)
