"""Step 50: lower the deck onto the frame under force (paper 2.4.2, mission A4)."""

from cellctl.cell.step import Step
from cellctl.steps.compensate import compensate
from cellctl.steps.contact_plan import contact_plan
from cellctl.steps.curves import curves_kept
from cellctl.steps.mate import mate_until_seated
from cellctl.steps.mating.plan import MatingPlan
from cellctl.steps.run import AssemblyRun


async def mate_deck(run: AssemblyRun) -> None:
    """Mate, measuring and correcting again before each further try after a false seat."""
    run.board.update(force_limit_n=run.recipe.mating.limit_force_n)

    async def measured_plan(attempt: int) -> MatingPlan:
        if attempt > 1:
            run.board.update(step=Step.COMPENSATE)
            await compensate(run)
            run.board.update(step=Step.MATE)
        plan = contact_plan(run, run.commissioned)
        await run.journal.mating_plan(plan)
        return plan

    async with curves_kept(run) as report:
        result = await mate_until_seated(
            run.cell.main, run.cell.guard, measured_plan, report, run.recipe.mating.max_tries
        )
    await run.journal.mating_result(result)
