"""Step 50: lower the deck onto the frame under force (paper 2.4.2, mission A4)."""

from cellctl.processes.deck_to_frame.mating.contact_plan import contact_plan
from cellctl.processes.deck_to_frame.mating.curves import curves_kept
from cellctl.processes.deck_to_frame.mating.mate import mate_until_seated
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.run import AssemblyRun
from cellctl.processes.deck_to_frame.steps.correct_pose import compensate
from cellctl.runtime.step import Step


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
