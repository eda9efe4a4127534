"""Step 10: measure where the frame stands (paper 2.2.1)."""

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.poses.pose_limits import require_near
from cellctl.processes.deck_to_frame.state import FrameMeasured, Ready


async def measure_frame(ready: Ready) -> FrameMeasured:
    """Measure the frame with both heads; the deck is still clear of the station."""
    run = ready.run
    base_T_frame = pose_from_xyzabc(run.recipe.base_T_frame)
    predicted = run.base_T_c1.inv() * base_T_frame
    measurement = await run.measure(run.facts.frame_features, predicted)
    measured = run.base_T_c1 * measurement.c1_T_part
    require_near("frame", run.recipe, base_T_frame, measured)
    # Kept beyond the run: the lift-off of the next Reset leaves along the frame as it really
    # stands.
    run.cell.memory.base_T_frame = measured
    await run.recorder.measurement("frame", measurement)
    return FrameMeasured(run, frame=measurement.pose)
