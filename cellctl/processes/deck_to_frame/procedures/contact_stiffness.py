"""Procedure 108: measures the stiffness of arm and contact by touching the frame a few times."""

from cellctl import log
from cellctl.calibration.checks import all_passed
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, CONTACT_STIFFNESS
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.mating.commissioning import (
    ContactStiffness,
    measure_contact_stiffness,
)
from cellctl.processes.deck_to_frame.mating.contact_plan import contact_plan
from cellctl.processes.deck_to_frame.moves.move_to_start import move_to_start
from cellctl.processes.deck_to_frame.moves.taught_poses import main_to_home
from cellctl.processes.deck_to_frame.procedures.contact_stiffness_picture import stiffness_picture
from cellctl.processes.deck_to_frame.procedures.contact_stiffness_result import (
    STIFFNESS,
    stiffness_checks,
    stiffness_record,
    touches_of,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.force_curves import curves_kept
from cellctl.processes.deck_to_frame.run import OpenRun
from cellctl.processes.deck_to_frame.run_facts import read_facts
from cellctl.processes.deck_to_frame.state import Corrected, Ready
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.processes.deck_to_frame.steps import CORRECT_POSE, TO_STAND_OFF
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.runtime.process import CellServices, RunContext
from cellctl.runtime.steps import HeldMeanwhile, StepRunner, Steps, StepSpec

_log = log.get(__name__)

MODE = "commissioning"


async def measure_contact_stiffness_on_cell(
    cell: DeckCell, recipe: DeckRecipe, services: CellServices, context: ProcedureContext
) -> ProcedureOutcome:
    """Measure and correct as an assembly does, then touch instead of mating once; deck stays.

    Planned with the bounds of the chosen recipe, as if nothing had been commissioned. Everything
    goes into a run of its own, with all force curves. Raises what the steps raise.
    """
    # Not the optional ones: a stiffness must not be measured with a plan that its own earlier
    # result has made faster.
    kinds = [kind for kind in CALIBRATIONS if kind.required]
    await context.record.look_at_files(recipe)
    facts = await read_facts(cell, recipe, services.calibrations, kinds)
    number = await context.record.open(recipe, MODE, facts.calibrations.records)
    recorder = RunRecorder(services.store, number)
    opened = OpenRun.of(facts, services, RunContext(recorder, context.safe_point))
    runner = StepRunner(services.board, context.safe_point, recorder)
    touch = StepSpec(108, "measure contact stiffness", _touch, contact=True)
    steps: Steps[Ready, ContactStiffness] = TO_STAND_OFF.then(CORRECT_POSE).then(touch)
    while True:
        try:
            measured = await runner.run(steps, await move_to_start(opened))
            break
        except HeldMeanwhile:
            _log.info("held meanwhile: everything is measured again")
    # After the last contact the deck stands at its stand-off, low over the station.
    await main_to_home(cell)
    touches, estimate = touches_of(measured), measured.estimate
    await context.keep_input({"contacts": [touch.to_input() for touch in touches]})
    checks = stiffness_checks(estimate, touches, recipe.mating)
    return ProcedureOutcome(
        kind=CONTACT_STIFFNESS.for_recipe(recipe.id),
        record=stiffness_record(estimate, touches, checks, recipe_id=recipe.id, run_number=number),
        passed=all_passed(checks),
        warnings=(),
        picture_png=await cell.workers.run(stiffness_picture, measured, checks),
        serial_number="",
        bounds=frozenset({STIFFNESS}),
    )


async def _touch(corrected: Corrected) -> ContactStiffness:
    run = corrected.run
    run.board.update(force_limit_n=run.recipe.mating.limit_force_n)
    # The bounds of the recipe alone, for the same reason.
    plan = contact_plan(corrected, Commissioned())
    await run.recorder.mating_plan(plan)
    async with curves_kept(run) as report:
        measured = await measure_contact_stiffness(run.cell.main, run.cell.guard, plan, report)
    await run.recorder.mating_result(measured.contacts[-1])
    return measured
