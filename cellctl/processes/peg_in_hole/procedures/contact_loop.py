"""Procedure 301: stiffness and dead time of the loop, measured on the face beside the hole."""

import numpy as np

from cellctl import log
from cellctl.calibration.checks import all_passed
from cellctl.cell.contact_motion.commissioning import CommissionedLoop, commission_contact
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.processes.peg_in_hole.calibrations import CONTACT_LOOP
from cellctl.processes.peg_in_hole.leaving import leave_hole
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.procedures.contact_loop_picture import loop_picture
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.record.loop_record import loop_checks, loop_record
from cellctl.processes.peg_in_hole.run import PegFacts, PegRun
from cellctl.processes.peg_in_hole.state import AtHome, FaceTouched
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.processes.peg_in_hole.steps import APPROACH, TOUCH_FACE
from cellctl.processes.peg_in_hole.steps.contact import recorded_loop
from cellctl.processes.peg_in_hole.steps.touch_face import CLEAR_M
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices, RunContext
from cellctl.runtime.steps import HeldMeanwhile, StepRunner, Steps, StepSpec

_log = log.get(__name__)

MODE = "commissioning"
_HIGH_M = 3e-3
"""Over the face: the chirp in free air swings by a third of it."""
_FREE_M = 1e-3
_TRAVEL_M = _HIGH_M + 2e-3
_FREE_M_S = 10e-3


async def measure_loop_on_cell(
    cell: PegCell, recipe: PegRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Touch the face as a run does, then press on it beside the hole; the part stays gripped.

    Planned with the bounds of the settings, as if nothing had been measured: a loop must not be
    measured at the speed that its own earlier figures allow. Everything goes into a run of its own,
    with every tick. Raises what the steps raise, and ``LoopFitRefused``.
    """
    facts = PegFacts.of(cell, recipe, cycle_plan(recipe, cell.settings))
    number = await context.record.open(recipe, MODE, ())
    recorder = RunRecorder(services.store, number)
    run = PegRun.of(facts, services.board, RunContext(recorder, context.safe_point))
    runner = StepRunner(services.board, context.safe_point, recorder)
    measure = StepSpec(301, "measure contact loop", _measure, contact=True)
    steps: Steps[AtHome, CommissionedLoop] = Steps.first(APPROACH).then(TOUCH_FACE).then(measure)
    while True:
        await leave_hole(cell)
        try:
            found = await runner.run(steps, AtHome(run))
            break
        except HeldMeanwhile:
            _log.info("held meanwhile: the face is touched again")
    await leave_hole(cell)
    checks = loop_checks(found, cell.settings)
    return ProcedureOutcome(
        kind=CONTACT_LOOP.for_recipe(recipe.id),
        record=loop_record(found, checks, recipe.id, number),
        passed=all_passed(checks),
        warnings=(),
        picture_png=await cell.cell.workers.run(loop_picture, found, checks),
        serial_number="",
    )


async def _measure(touched: FaceTouched) -> CommissionedLoop:
    run, plan = touched.run, touched.run.facts.plan
    run.say("press on the face beside the hole")
    async with recorded_loop(run, touched.frames, keys.LOOP) as loop:
        motions = StreamedContact(loop)
        # Where the face was touched: the peg stands beside the hole there, wherever that is.
        place = np.array([plan.face.radius_m, 0.0, -_HIGH_M])
        await motions.move_free(place, np.zeros(3), _FREE_M_S)
        place[2] += plan.face.datum_depth_m
        await motions.move_free(place, np.zeros(3), _FREE_M_S)
        found = await commission_contact(loop, _TRAVEL_M, _FREE_M)
        await motions.back_out(CLEAR_M)
    return found
