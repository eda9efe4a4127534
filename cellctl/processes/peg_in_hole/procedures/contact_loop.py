"""Procedure 301: stiffness and dead time of the loop, measured on the face beside the hole."""

import numpy as np

from cellctl.calibration.checks import all_passed
from cellctl.cell.contact_motion.commissioning import CommissionedLoop, commission_contact
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.processes.peg_in_hole.calibrations import CONTACT_LOOP
from cellctl.processes.peg_in_hole.procedures.after_the_face import after_the_face
from cellctl.processes.peg_in_hole.procedures.contact_loop_picture import loop_picture
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.loop_record import (
    DEAD_TIME,
    STIFFNESS,
    loop_checks,
    loop_record,
)
from cellctl.processes.peg_in_hole.search.face import CLEAR_M
from cellctl.processes.peg_in_hole.state import FaceTouched
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.processes.peg_in_hole.steps.contact import recorded_loop
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices
from cellctl.runtime.steps import StepSpec

_HIGH_M = 3e-3
"""Height over the face: the chirp in free air swings by a third of it."""
_FREE_M = 1e-3
"""Amplitude of the chirp in free air (section 4.5 of the study of insertion by touch)."""
_TRAVEL_M = _HIGH_M + 2e-3
"""The face has to be met on this way; it was touched before, so 2 mm of room are plenty."""
_FREE_M_S = 10e-3
"""Speed over the face, which was touched before."""


async def measure_loop_on_cell(
    cell: PegCell, recipe: PegRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Touch the face as a run does, then press on it beside the hole; the part stays gripped.

    Planned with the bounds of the settings, as if nothing had been measured: a loop must not be
    measured at the speed that its own earlier figures allow. Everything goes into a run of its own,
    with every tick. Raises what the steps raise, and ``LoopFitRefused``.
    """
    measure = StepSpec(301, "measure contact loop", _measure, contact=True)
    found, number = await after_the_face(cell, recipe, services, context, measure)
    checks = loop_checks(found, cell.settings)
    return ProcedureOutcome(
        kind=CONTACT_LOOP.for_recipe(recipe.id),
        record=loop_record(found, checks, recipe.id, number),
        passed=all_passed(checks),
        warnings=(),
        picture_png=await cell.cell.workers.run(loop_picture, found, checks),
        serial_number="",
        bounds=frozenset({STIFFNESS, DEAD_TIME}),
    )


async def _measure(touched: FaceTouched) -> CommissionedLoop:
    run, plan = touched.run, touched.run.facts.plan
    run.say("press on the face beside the hole")
    async with recorded_loop(run, touched.frames, keys.LOOP) as loop:
        motions = StreamedContact(loop)
        # Where the face was touched last, over which the tip stands: it is beside the hole there,
        # wherever that is, and a way to another place would count against the stream's travel.
        place = np.array([*loop.sample.task_position_tip_m[:2], -_HIGH_M])
        await motions.move_free(place, np.zeros(3), _FREE_M_S)
        place[2] += plan.face.datum_depth_m
        await motions.move_free(place, np.zeros(3), _FREE_M_S)
        found = await commission_contact(loop, _TRAVEL_M, _FREE_M)
        await motions.back_out(CLEAR_M)
    return found
