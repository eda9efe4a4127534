"""What procedures in contact begin with: the face touched as a run does, in a record of its own."""

from typing import TypeVar

from cellctl import log
from cellctl.processes.peg_in_hole.leaving import leave_hole
from cellctl.processes.peg_in_hole.plan.cycle_plan import cycle_plan
from cellctl.processes.peg_in_hole.recipe import PegRecipe
from cellctl.processes.peg_in_hole.run import PegFacts, PegRun
from cellctl.processes.peg_in_hole.state import AtHome, FaceTouched
from cellctl.processes.peg_in_hole.stations import PegCell
from cellctl.processes.peg_in_hole.steps import APPROACH, TOUCH_FACE
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.procedure import ProcedureContext
from cellctl.runtime.process import CellServices, RunContext
from cellctl.runtime.steps import HeldMeanwhile, StepRunner, Steps, StepSpec

_log = log.get(__name__)

Found = TypeVar("Found")
MODE = "commissioning"


async def after_the_face(
    cell: PegCell,
    recipe: PegRecipe,
    services: CellServices,
    context: ProcedureContext,
    measure: StepSpec[FaceTouched, Found],
) -> tuple[Found, int]:
    """Approach, touch the face, measure, and leave; the result and the number of the record.

    Planned with the bounds of the settings and compared with nothing, as if nothing had been
    measured. Raises what the steps raise.
    """
    facts = PegFacts.of(cell, recipe, cycle_plan(recipe, cell.settings))
    number = await context.record.open(recipe, MODE, ())
    recorder = RunRecorder(services.store, number)
    run = PegRun.of(facts, services.board, RunContext(recorder, context.safe_point))
    runner = StepRunner(services.board, context.safe_point, recorder)
    steps: Steps[AtHome, Found] = Steps.first(APPROACH).then(TOUCH_FACE).then(measure)
    while True:
        await leave_hole(cell)
        try:
            found = await runner.run(steps, AtHome(run))
            break
        except HeldMeanwhile:
            _log.info("held meanwhile: the face is touched again")
    await leave_hole(cell)
    return found, number
