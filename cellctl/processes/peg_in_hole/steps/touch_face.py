"""Step 20: the face is touched, and frame A put onto it."""

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.panel_reference import PanelReference, require_panel_at_reference
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.run import PegRun
from cellctl.processes.peg_in_hole.search.face import CLEAR_M, touch_face
from cellctl.processes.peg_in_hole.state import AboveHole, FaceTouched
from cellctl.processes.peg_in_hole.stations import on_face
from cellctl.processes.peg_in_hole.steps.contact import contact, watch_phase
from cellctl.records.figures import Limit


async def find_face(above: AboveHole) -> FaceTouched:
    """Raises ``FaceAbsent``, ``FaceUneven``, ``FaceTilted``, ``PanelOffReference`` or what ends the
    stream."""
    run, plan = above.run, above.run.facts.plan
    async with contact(run, above.frames, keys.FACE) as motions:
        await watch_phase(run, motions, CyclePhase.FACE)
        face = await touch_face(motions, plan.task, plan.face)
        await motions.back_out(CLEAR_M - face.depth_m + plan.face.radius_m * face.tilt_rad)
    await run.recorder.figure(keys.FACE_HEIGHT, -face.depth_m / MM, "mm")
    await run.recorder.figure(keys.FACE_TILT, face.tilt_rad, "rad")
    frames = on_face(above.frames, face)
    if run.facts.panel is not None:
        await _compare(run, run.facts.panel, frames)
    return FaceTouched(run, frames, face.yields_m)


async def _compare(run: PegRun, panel: PanelReference, frames: ContactFrames) -> None:
    settings = run.facts.cell.settings
    checks = panel.checks(frames.base_T_task, settings.panel_shift_mm, settings.panel_turn_deg)
    for key, check in zip((keys.PANEL_SHIFT, keys.PANEL_TURN), checks, strict=True):
        await run.recorder.figure(key, check.value, check.unit, limit=Limit(upper=check.limit))
    require_panel_at_reference(checks)
