"""Step 50: lower the deck onto the frame under force (paper 2.4.2, mission A4)."""

from cellctl.processes.deck_to_frame.mating.contact_plan import contact_plan
from cellctl.processes.deck_to_frame.mating.mate import mate_until_seated
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.record.force_curves import curves_kept
from cellctl.processes.deck_to_frame.state import Corrected, Seated
from cellctl.processes.deck_to_frame.steps.correct_pose import LABEL, NUMBER, correct_pose


async def mate_deck(corrected: Corrected) -> Seated:
    """Mate, measuring and correcting again before each further try after a false seat."""
    run, latest = corrected.run, corrected
    phase = run.recorder.recorder.phase
    run.board.update(force_limit_n=run.recipe.mating.limit_force_n)

    async def measured_plan(attempt: int) -> MatingPlan:
        nonlocal latest
        if attempt > 1:
            # Shown to the line as the step that it is; contact comes only after it.
            mating = run.board.current
            run.board.update(step=NUMBER, step_label=LABEL, contact=False, safe_point_ahead=True)
            await phase(NUMBER, LABEL)
            latest = await correct_pose(latest)
            # The last chance for a Hold, or for a line that was lost meanwhile, before contact.
            await run.obey_hold()
            run.board.update(
                step=mating.step,
                step_label=mating.step_label,
                contact=True,
                safe_point_ahead=mating.safe_point_ahead,
            )
            await phase(mating.step, mating.step_label)
        # A plan for each attempt: window and speed follow from the uncertainty of the latest
        # measurement.
        plan = contact_plan(latest, run.facts.commissioned)
        await run.recorder.mating_plan(plan)
        return plan

    async with curves_kept(run) as report:
        result = await mate_until_seated(
            run.cell.main,
            run.cell.guard,
            measured_plan,
            report,
            max_tries=run.recipe.mating.max_tries,
            interruption=run.opened.interruption,
        )
    await run.recorder.mating_result(result)
    return Seated(
        run,
        latest.frame,
        latest.flange_T_deck,
        latest.commanded,
        latest.base_T_flange,
        latest.M_T_D,
        latest.measured_at,
    )
