"""Step 20: the face is touched, and frame A put onto it."""

from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.search.face import touch_face
from cellctl.processes.peg_in_hole.state import AboveHole, FaceTouched
from cellctl.processes.peg_in_hole.stations import on_face
from cellctl.processes.peg_in_hole.steps.contact import contact

CLEAR_M = 1e-3
"""The tip is left so high over the face."""


async def find_face(above: AboveHole) -> FaceTouched:
    """Raises ``FaceAbsent``, ``FaceUneven``, ``FaceTilted`` or what ends the stream."""
    run, plan = above.run, above.run.facts.plan
    async with contact(run, above.frames, keys.FACE) as motions:
        face = await touch_face(motions, plan.task, plan.face)
        await motions.back_out(CLEAR_M - face.depth_m + plan.face.radius_m * face.tilt_rad)
    await run.recorder.figure(keys.FACE_HEIGHT, -face.depth_m / MM, "mm")
    await run.recorder.figure(keys.FACE_TILT, face.tilt_rad, "rad")
    return FaceTouched(run, on_face(above.frames, face))
