"""Procedure 108: how stiff arm and contact are together, by touching the frame a few times."""

from cellctl.calibration.checks import all_passed
from cellctl.procedures.context import ProcedureContext, ProcedureOutcome
from cellctl.procedures.pictures import stiffness_picture
from cellctl.processes.deck_to_frame.contact_stiffness_result import (
    stiffness_checks,
    stiffness_record,
)
from cellctl.processes.deck_to_frame.journal import Journal
from cellctl.processes.deck_to_frame.mating.commissioning import (
    ContactStiffness,
    measure_contact_stiffness,
)
from cellctl.processes.deck_to_frame.mating.contact_plan import contact_plan
from cellctl.processes.deck_to_frame.mating.curves import curves_kept
from cellctl.processes.deck_to_frame.preparation import (
    prepare,
    repeat_until_unheld,
    to_the_beginning,
)
from cellctl.processes.deck_to_frame.run import AssemblyRun
from cellctl.processes.deck_to_frame.sequence import STEPS, Sequence
from cellctl.processes.deck_to_frame.taught_poses import main_to_home
from cellctl.runtime.commissioned import Commissioned, stiffness_kind
from cellctl.runtime.step import Step

MODE = "commissioning"


async def measure_contact_stiffness_on_cell(context: ProcedureContext) -> ProcedureOutcome:
    """Measure and correct as an assembly does, then touch instead of mating once; deck stays.

    Planned with the bounds of the chosen recipe, as if nothing had been commissioned. Everything
    goes into a run of its own, with all force curves. Raises what the steps raise.
    """
    cell, board = context.cell, context.board
    recipe = context.recipe
    prepared = await prepare(cell, context.calibrations, recipe)
    number = await context.record.open(recipe, MODE, prepared.stored, prepared.calibrations.ids)
    await cell.guard.set_compensation(prepared.calibrations.compensation)
    await to_the_beginning(cell, board)
    journal = Journal(context.record.archive, cell.workers, number)
    found: list[ContactStiffness] = []

    async def touch(run: AssemblyRun) -> None:
        found.append(await _touch(run))

    before = tuple(step for step in STEPS if step[0] < Step.MATE)
    sequence = Sequence(steps=(*before, (Step.MEASURE_CONTACT_STIFFNESS, touch)))
    await repeat_until_unheld(
        sequence,
        cell=cell,
        prepared=prepared,
        board=board,
        journal=journal,
        pause=context.safe_point,
    )
    await main_to_home(cell)
    measured = found[-1]
    checks = stiffness_checks(measured, recipe.mating)
    return ProcedureOutcome(
        item=stiffness_kind(recipe.id),
        record=stiffness_record(measured, checks, recipe.id, number),
        passed=all_passed(checks),
        warnings=(),
        picture_png=await cell.workers.run(stiffness_picture, measured, checks),
        serial_number="",
    )


async def _touch(run: AssemblyRun) -> ContactStiffness:
    run.board.update(force_limit_n=run.recipe.mating.limit_force_n)
    plan = contact_plan(run, Commissioned())
    await run.journal.mating_plan(plan)
    async with curves_kept(run) as report:
        measured = await measure_contact_stiffness(run.cell.main, run.cell.guard, plan, report)
    await run.journal.mating_result(measured.contacts[-1])
    return measured
